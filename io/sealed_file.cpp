#include "io/sealed_file.h"

#include "engine/archive.h"
#include "io/atomic_file.h"
#include "io/checksum.h"

#include <limits>

namespace sigmaflow::io {
namespace {

constexpr std::string_view magic = "sigmaflow sealed file\n";
constexpr const char* not_sealed = "is not a file that sigmaflow has sealed";

}

std::string sealed(const Seal& seal, std::string_view bytes)
{
    ArchiveWriter a;
    a.raw(magic.data(), magic.size());
    a(std::string(seal.kind), seal.version, std::uint64_t{bytes.size()});
    a.raw(bytes.data(), bytes.size());
    const Digest digest = checksum(a.bytes());
    a(digest);
    return a.bytes();
}

void check_seal(std::string_view content, const std::string& file)
{
    const auto refuse = [&](const std::string& problem) {
        throw Error(ErrorKind::input, file, problem);
    };
    if (!content.starts_with(magic)) refuse(not_sealed);
    Digest digest{};
    if (content.size() < magic.size() + sizeof digest) refuse("is cut off");
    const std::string_view all = content.substr(0, content.size() - sizeof digest);
    ArchiveReader(content.substr(all.size()))(digest);
    if (checksum(all) != digest) refuse("is damaged: its checksum is another one");
}

std::string unsealed(std::string_view content, const Seal& seal, const std::string& file)
{
    const auto refuse = [&](const std::string& problem) {
        throw Error(ErrorKind::input, file, problem);
    };
    check_seal(content, file);
    const std::string_view all = content.substr(0, content.size() - sizeof(Digest));
    // what follows was written as it is, by this or another version of the program
    try {
        ArchiveReader a(all.substr(magic.size()));
        std::string kind;
        std::uint32_t version = 0;
        std::uint64_t size = 0;
        a(kind, version, size);
        if (kind != seal.kind) refuse("is a " + kind + ", not a " + std::string(seal.kind));
        if (version != seal.version)
            refuse("has version " + std::to_string(version) +
                   " of the format, this program reads " + std::to_string(seal.version));
        if (size != a.left()) refuse("is damaged: its length is another one");
        return std::string(all.substr(all.size() - a.left()));
    } catch (const Error& error) {
        throw error.where().empty() ? error.within(file) : error;
    }
}

void write_sealed(const std::filesystem::path& path, const Seal& seal, std::string_view bytes)
{
    write_file(path, sealed(seal, bytes));
}

std::string sealed_content(const std::filesystem::path& path)
{
    if (first_bytes(path, magic.size()) != magic)
        throw Error(ErrorKind::input, path.string(), not_sealed);
    return read_file(path, std::numeric_limits<std::size_t>::max());
}

std::string read_sealed(const std::filesystem::path& path, const Seal& seal)
{
    return unsealed(sealed_content(path), seal, path.string());
}

}
