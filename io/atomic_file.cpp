#include "io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace sigmaflow::io {
namespace {

/// Closes a descriptor at the end of the scope; for reading, where closing cannot lose anything.
class Descriptor {
public:
    explicit Descriptor(int value) : value_(value) {}
    ~Descriptor()
    {
        if (value_ >= 0) ::close(value_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int value() const { return value_; }

private:
    int value_;
};

/// Pipes and devices cannot be synced; that is no error.
bool synced(int descriptor)
{
    return ::fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP;
}

void sync_path(const std::filesystem::path& path, int flags)
{
    const Descriptor opened(::open(path.c_str(), flags | O_CLOEXEC));
    if (opened.value() < 0 || !synced(opened.value())) throw write_error(path, errno);
}

}

Error write_error(const std::filesystem::path& path, int error_number)
{
    const bool full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
    return Error(full ? ErrorKind::no_space : ErrorKind::file, path.string(),
                 std::string("cannot be written: ") + std::strerror(error_number));
}

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666))
{
    if (descriptor_ < 0) throw write_error(path_, errno);
}

OutputFile::OutputFile(std::filesystem::path path, std::uint64_t size)
    : path_(std::move(path)), descriptor_(::open(path_.c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC))
{
    if (descriptor_ < 0) throw write_error(path_, errno);
    const auto end = static_cast<off_t>(size);
    if (::ftruncate(descriptor_, end) == 0 && ::lseek(descriptor_, end, SEEK_SET) == end) return;
    const int reason = errno;
    ::close(descriptor_);
    throw write_error(path_, reason);
}

OutputFile::~OutputFile()
{
    if (descriptor_ >= 0) ::close(descriptor_);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1))
{
}

void OutputFile::write(std::string_view text)
{
    while (!text.empty()) {
        const ssize_t written = ::write(descriptor_, text.data(), text.size());
        if (written < 0 && errno != EINTR) throw write_error(path_, errno);
        if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
    }
}

void OutputFile::sync()
{
    if (!synced(descriptor_)) throw write_error(path_, errno);
}

void OutputFile::close()
{
    if (::close(std::exchange(descriptor_, -1)) != 0) throw write_error(path_, errno);
}

void commit_file(const std::filesystem::path& temporary, const std::filesystem::path& path)
{
    sync_path(temporary, O_RDONLY);
    if (::rename(temporary.c_str(), path.c_str()) != 0) throw write_error(path, errno);
    sync_entry(path);
}

void sync_entry(const std::filesystem::path& path)
{
    sync_path(path.has_parent_path() ? path.parent_path() : ".", O_RDONLY | O_DIRECTORY);
}

void write_file(const std::filesystem::path& path, std::string_view text)
{
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    const bool special = std::filesystem::exists(status) &&
                         !std::filesystem::is_regular_file(status) &&
                         !std::filesystem::is_directory(status);
    std::filesystem::path target = path;
    if (!special) target += ".tmp";
    try {
        OutputFile file(target);
        file.write(text);
        file.close();
        if (!special) commit_file(target, path);
    } catch (const Error&) {
        if (!special) std::filesystem::remove(target, ignored);
        throw;
    }
}

namespace {

Error unreadable(const std::filesystem::path& path, const std::string& problem)
{
    return Error(ErrorKind::missing, path.empty() ? "\"\"" : path.string(), problem);
}

std::string system_reason()
{
    return std::string("cannot be read: ") + std::strerror(errno);
}

void require_regular(const std::filesystem::path& path, const struct stat& status)
{
    if (S_ISDIR(status.st_mode)) throw unreadable(path, "is a folder, not a file");
    if (!S_ISREG(status.st_mode))
        throw unreadable(path, "is not a regular file (a device, pipe or socket)");
}

/// Waits for nobody: a pipe or a device is recognised before it is opened.
int open_regular(const std::filesystem::path& path)
{
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) throw unreadable(path, system_reason());
    require_regular(path, status);
    return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

/// Its size; the file may have been exchanged since it was looked at.
std::size_t size_of(const Descriptor& opened, const std::filesystem::path& path)
{
    struct stat status {};
    if (opened.value() < 0 || ::fstat(opened.value(), &status) != 0)
        throw unreadable(path, system_reason());
    require_regular(path, status);
    return static_cast<std::size_t>(status.st_size);
}

}

void read_pieces(const std::filesystem::path& path, std::uint64_t size,
                 const std::function<void(std::string_view)>& take)
{
    const Descriptor opened(open_regular(path));
    if (opened.value() < 0) throw unreadable(path, system_reason());
    std::string buffer(std::size_t{1} << 20, '\0');
    while (size > 0) {
        const auto wanted = std::min<std::uint64_t>(size, buffer.size());
        const ssize_t got = ::read(opened.value(), buffer.data(), wanted);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw unreadable(path, system_reason());
        if (got == 0) return;
        take({buffer.data(), static_cast<std::size_t>(got)});
        size -= static_cast<std::uint64_t>(got);
    }
}

std::string read_file(const std::filesystem::path& path, std::size_t largest)
{
    const Descriptor opened(open_regular(path));
    const auto refuse_above = [&](std::size_t size) {
        if (size > largest)
            throw Error(ErrorKind::input, path.string(),
                        "must not be larger than " + std::to_string(largest) + " bytes, got " +
                            std::to_string(size));
    };
    const std::size_t size = size_of(opened, path);
    refuse_above(size);
    std::string text(size + 1, '\0');  // the last read finds the end
    std::size_t used = 0;
    while (true) {
        const ssize_t got = ::read(opened.value(), text.data() + used, text.size() - used);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw unreadable(path, system_reason());
        if (got == 0) break;
        used += static_cast<std::size_t>(got);
        refuse_above(used);  // it grows
        if (used == text.size()) text.resize(2 * used);
    }
    text.resize(used);
    return text;
}

std::string first_bytes(const std::filesystem::path& path, std::size_t count)
{
    const Descriptor opened(open_regular(path));
    std::string text(std::min(count, size_of(opened, path)), '\0');
    const ssize_t got = ::read(opened.value(), text.data(), text.size());
    if (got < 0) throw unreadable(path, system_reason());
    text.resize(static_cast<std::size_t>(got));
    return text;
}

}
