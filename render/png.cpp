// render/png.cpp -- PNG through libpng's simplified interface, which returns errors instead of
// jumping.
#include "engine/error.h"
#include "render/image.h"

#include <png.h>
#include <unistd.h>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

namespace sigmaflow::render {
namespace {

Error write_failure(const std::filesystem::path& path, int code)
{
    const bool full = code == ENOSPC || code == EDQUOT;
    return Error(full ? ErrorKind::no_space : ErrorKind::file, path.string(),
                 std::string("cannot be written: ") + std::strerror(code));
}

std::vector<char> encoded(const std::filesystem::path& path, const Image& image)
{
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width);
    header.height = static_cast<png_uint_32>(image.height);
    header.format = PNG_FORMAT_RGB;
    std::vector<char> bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
    png_alloc_size_t size = bytes.size();
    if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr))
        throw Error(ErrorKind::internal, path.string(), header.message);
    bytes.resize(size);
    return bytes;
}

void write_bytes(const std::filesystem::path& path, const std::vector<char>& bytes)
{
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (!file) throw write_failure(path, errno);
    errno = 0;
    bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    written = written && std::fflush(file) == 0;
    int code = errno;
    if (std::fclose(file) != 0 && written) {
        written = false;
        code = errno;
    }
    if (!written) {
        std::remove(path.c_str());
        throw write_failure(path, code);
    }
}

}

void write_png(const std::filesystem::path& path, const Image& image)
{
    // The process id keeps two programs that write the same picture from mixing their bytes.
    std::filesystem::path temporary = path;
    temporary += '.';
    temporary += std::to_string(getpid());
    temporary += ".tmp";
    write_bytes(temporary, encoded(path, image));
    if (std::rename(temporary.c_str(), path.c_str()) != 0) {
        const int code = errno;
        std::remove(temporary.c_str());
        throw write_failure(path, code);
    }
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
