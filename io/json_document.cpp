#include "io/json_document.h"

#include "io/json_parse.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstring>

namespace sigmaflow::io {

namespace {

/// A pipe or a device is recognised before it is opened: opening could wait for ever.
std::string read_regular_file(const std::filesystem::path& path)
{
    const auto refuse = [&](const std::string& problem) {
        throw Error(ErrorKind::missing, path.string(), problem);
    };
    const auto check = [&](const struct stat& status) {
        if (S_ISDIR(status.st_mode)) refuse("is a folder, not a file");
        if (!S_ISREG(status.st_mode)) refuse("is not a regular file");
        if (status.st_size > static_cast<off_t>(largest_json_file))
            throw Error(
                ErrorKind::input, path.string(),
                "must not be larger than 64 MiB, got " + std::to_string(status.st_size) + " bytes");
    };
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
        refuse(errno == ENOENT ? "no such file" : std::strerror(errno));
    check(status);
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) refuse(std::string("cannot be opened: ") + std::strerror(errno));
    const std::unique_ptr<const int, void (*)(const int*)> closer(
        &file, [](const int* f) { ::close(*f); });
    if (::fstat(file, &status) != 0) refuse(std::strerror(errno));
    check(status);  // it may have been exchanged since

    std::string text;
    std::array<char, 65536> buffer;
    while (text.size() <= largest_json_file) {
        const ssize_t count = ::read(file, buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) refuse(std::string("cannot be read: ") + std::strerror(errno));
        if (count == 0) break;
        text.append(buffer.data(), static_cast<std::size_t>(count));
    }
    return text;
}

}

JsonDocument JsonDocument::read(const std::filesystem::path& path)
{
    return parse(read_regular_file(path), path.string());
}

JsonDocument JsonDocument::parse(std::string text, std::string name)
{
    auto tree = std::make_shared<JsonTree>();
    tree->name = std::move(name);
    tree->text = std::move(text);
    parse_json(*tree);
    return JsonDocument(std::move(tree));
}

JsonNode JsonDocument::root() const&
{
    return JsonNode(tree_.get(), &tree_->root, "");
}

const std::string& JsonDocument::text() const
{
    return tree_->text;
}

}
