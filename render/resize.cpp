// render/resize.cpp -- pictures of another size.
#include "render/image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sigmaflow::render {
namespace {

constexpr double lobes = 3;

double lanczos(double x)
{
    if (std::abs(x) >= lobes) return 0;
    if (std::abs(x) < 1e-9) return 1;
    const double t = std::numbers::pi * x;
    return lobes * std::sin(t) * std::sin(t / lobes) / (t * t);
}

/// What one pixel of the new row is made of.
struct Window {
    int first = 0;
    std::vector<float> weights;  // of the pixels from `first` on, sum 1
};

/// Pixels are where their centres are. At the border the weights that are left count more.
std::vector<Window> windows(int from, int to)
{
    const double step = static_cast<double>(from) / to, stretch = std::max(1.0, step);
    std::vector<Window> result(static_cast<std::size_t>(to));
    for (int k = 0; k < to; ++k) {
        const double centre = (k + 0.5) * step - 0.5, reach = lobes * stretch;
        Window& window = result[static_cast<std::size_t>(k)];
        window.first = std::max(0, static_cast<int>(std::ceil(centre - reach)));
        const int last = std::min(from - 1, static_cast<int>(std::floor(centre + reach)));
        double sum = 0;
        for (int i = window.first; i <= last; ++i) sum += lanczos((i - centre) / stretch);
        for (int i = window.first; i <= last; ++i)
            window.weights.push_back(static_cast<float>(lanczos((i - centre) / stretch) / sum));
    }
    return result;
}

std::uint8_t rounded(float value)
{
    return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
}

}

Image resized(const Image& image, int width, int height)
{
    if (width == image.width && height == image.height) return image;
    const std::vector<Window> across = windows(image.width, width);
    const std::vector<Window> down = windows(image.height, height);
    const std::size_t row_size = 3 * static_cast<std::size_t>(width);
    std::vector<float> narrow(row_size * static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < width; ++x) {
            const Window& window = across[static_cast<std::size_t>(x)];
            const std::uint8_t* source = image.pixel(window.first, y);
            float* target = narrow.data() + row_size * static_cast<std::size_t>(y) + 3 * x;
            for (float weight : window.weights)
                for (int channel = 0; channel < 3; ++channel)
                    target[channel] += weight * static_cast<float>(*source++);
        }
    Image result(width, height);
    std::vector<float> row(row_size);
    for (int y = 0; y < height; ++y) {
        const Window& window = down[static_cast<std::size_t>(y)];
        std::fill(row.begin(), row.end(), 0.0f);
        const float* source = narrow.data() + row_size * static_cast<std::size_t>(window.first);
        for (float weight : window.weights)
            for (float& value : row) value += weight * *source++;
        std::transform(row.begin(), row.end(), result.pixel(0, y), rounded);
    }
    return result;
}

}
