// render/image.h -- pictures in memory and as PNG.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sigmaflow::render {

using Colour = std::array<int, 3>;  // red, green, blue in 0..255

/// 8-bit RGB, first row at the top.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // [height * width * 3]

    Image() = default;
    Image(int image_width, int image_height, Colour background = {255, 255, 255});

    const std::uint8_t* pixel(int column, int row) const
    {
        return rgb.data() + 3 * (std::size_t(row) * width + column);
    }
    std::uint8_t* pixel(int column, int row)
    {
        return rgb.data() + 3 * (std::size_t(row) * width + column);
    }
};

/// Copies `part` into `whole` with its top left corner at (column, row); what lies outside is cut.
void paste(Image& whole, const Image& part, int column, int row);

/// Every pixel is the mean of factor x factor pixels. Width and height are multiples of factor.
Image shrink(const Image& image, int factor);

/// The picture in another size > 0, filtered with Lanczos' window of three lobes (C. E. Duchon,
/// J. Appl. Meteorol. 18, 1016, 1979), which is stretched when the picture shrinks: flat areas stay
/// what they are, and details finer than the new pixels become their mean.
Image resized(const Image& image, int width, int height);

/// Pictures in one row, centred vertically, `gap` white pixels between them.
Image side_by_side(const std::vector<Image>& images, int gap = 0);

/// Pictures in one column, centred horizontally, `gap` white pixels between them.
Image stacked(const std::vector<Image>& images, int gap = 0);

/// The picture as a PNG file, to be written by io::write_file.
std::string png_bytes(const Image& image);

/// Transparent pixels are laid on white. Errors: missing (cannot be read), input (not a PNG file).
Image read_png(const std::filesystem::path& path);

/// Empty if pictures can be drawn here, otherwise the reason and the mend. Really draws a pixel, so
/// it takes some tenths of a second. Never aborts the process.
std::string why_unavailable();

}
