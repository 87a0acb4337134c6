// render/image.cpp
#include "render/image.h"

#include <algorithm>
#include <cassert>

namespace sigmaflow::render {

Image::Image(int image_width, int image_height, Colour background)
    : width(image_width), height(image_height), rgb(std::size_t(image_width) * image_height * 3)
{
    for (std::size_t i = 0; i < rgb.size(); ++i)
        rgb[i] = static_cast<std::uint8_t>(background[i % 3]);
}

void paste(Image& whole, const Image& part, int column, int row)
{
    const int first = std::max(0, -column);
    const int last = std::min(part.width, whole.width - column);
    if (first >= last) return;
    for (int y = std::max(0, -row); y < std::min(part.height, whole.height - row); ++y)
        std::copy(part.pixel(first, y), part.pixel(first, y) + 3 * (last - first),
                  whole.pixel(column + first, row + y));
}

Image shrink(const Image& image, int factor)
{
    assert(factor >= 1 && image.width % factor == 0 && image.height % factor == 0);
    Image small(image.width / factor, image.height / factor);
    const int area = factor * factor;
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            for (int channel = 0; channel < 3; ++channel) {
                int sum = area / 2;  // rounds to nearest
                for (int dy = 0; dy < factor; ++dy)
                    for (int dx = 0; dx < factor; ++dx)
                        sum += image.pixel(factor * x + dx, factor * y + dy)[channel];
                small.pixel(x, y)[channel] = static_cast<std::uint8_t>(sum / area);
            }
        }
    }
    return small;
}

Image side_by_side(const std::vector<Image>& images, int gap)
{
    int width = 0, height = 0;
    for (const Image& image : images) {
        width += image.width + (width > 0 ? gap : 0);
        height = std::max(height, image.height);
    }
    Image row(width, height);
    int column = 0;
    for (const Image& image : images) {
        paste(row, image, column, (height - image.height) / 2);
        column += image.width + gap;
    }
    return row;
}

Image stacked(const std::vector<Image>& images, int gap)
{
    int width = 0, height = 0;
    for (const Image& image : images) {
        height += image.height + (height > 0 ? gap : 0);
        width = std::max(width, image.width);
    }
    Image column(width, height);
    int row = 0;
    for (const Image& image : images) {
        paste(column, image, (width - image.width) / 2, row);
        row += image.height + gap;
    }
    return column;
}

}
