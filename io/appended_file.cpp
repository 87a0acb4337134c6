#include "io/appended_file.h"

namespace sigmaflow::io {

Checksum verify(const std::filesystem::path& path, const Mark& mark)
{
    Checksum sum;
    std::uint64_t size = 0;
    read_pieces(path, mark.size, [&](std::string_view piece) {
        sum.add(piece);
        size += piece.size();
    });
    if (size < mark.size)
        throw Error(ErrorKind::input, path.string(),
                    "must have at least " + std::to_string(mark.size) + " bytes, has " +
                        std::to_string(size));
    if (sum.digest() != mark.digest)
        throw Error(ErrorKind::input, path.string(),
                    "was changed in its first " + std::to_string(mark.size) + " bytes");
    return sum;
}

AppendedFile::AppendedFile(const std::filesystem::path& path) : file_(path)
{
    sync_entry(path);  // marks promise that the file is there
}

AppendedFile::AppendedFile(const std::filesystem::path& path, const Mark& mark)
    : sum_(verify(path, mark)), file_(path, mark.size), size_(mark.size)
{
}

void AppendedFile::write(std::string_view bytes)
{
    file_.write(bytes);
    sum_.add(bytes);
    size_ += bytes.size();
}

Mark AppendedFile::mark()
{
    file_.sync();
    return {size_, sum_.digest()};
}

void AppendedFile::finish()
{
    file_.sync();
    file_.close();
}

}
