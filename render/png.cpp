// render/png.cpp -- PNG through libpng's simplified interface, which returns errors instead of
// jumping.
#include "engine/error.h"
#include "render/image.h"

#include <png.h>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace sigmaflow::render {

std::string png_bytes(const Image& image)
{
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width);
    header.height = static_cast<png_uint_32>(image.height);
    header.format = PNG_FORMAT_RGB;
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
    png_alloc_size_t size = bytes.size();
    if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr))
        throw Error(ErrorKind::internal, "PNG", header.message);
    bytes.resize(size);
    return bytes;
}

Image read_png(const std::filesystem::path& path)
{
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error(ErrorKind::missing, path.string(),
                    std::string("cannot be read: ") + std::strerror(errno));
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};

    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()))
        throw Error(ErrorKind::input, path.string(),
                    std::string("not a PNG file: ") + header.message);
    header.format = PNG_FORMAT_RGB;
    Image image(static_cast<int>(header.width), static_cast<int>(header.height));
    const png_color white{255, 255, 255};
    if (!png_image_finish_read(&header, &white, image.rgb.data(), 0, nullptr))
        throw Error(ErrorKind::input, path.string(),
                    std::string("damaged PNG file: ") + header.message);
    return image;
}

}
