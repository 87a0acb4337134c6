#include "io/run_journal.h"

#include "engine/archive.h"

#include <fstream>

namespace sigmaflow::io {
namespace {

enum class Entry : std::uint8_t { sample, frame };

template <class... Parts>
std::string entry_bytes(Entry kind, const Parts&... parts)
{
    ArchiveWriter content;
    content(parts...);
    ArchiveWriter entry;
    entry(static_cast<std::uint8_t>(kind), content.bytes());
    return entry.bytes();
}

}

void RunJournal::append(const Sample& sample, bool on_grid)
{
    file_.write(entry_bytes(Entry::sample, sample, on_grid));
}

void RunJournal::append(const Frame& frame)
{
    file_.write(entry_bytes(Entry::frame, frame));
}

void read_journal(const std::filesystem::path& path, const JournalVisitor& visitor)
{
    std::error_code unknown;
    std::uint64_t left = std::filesystem::file_size(path, unknown);
    std::ifstream file(path, std::ios::binary);
    if (unknown || !file) throw Error(ErrorKind::missing, path.string(), "cannot be read");
    constexpr std::size_t head_size = sizeof(std::uint8_t) + sizeof(std::uint64_t);
    std::string content;
    const auto refuse = [&](const std::string& problem) {
        throw Error(ErrorKind::input, path.string(), problem);
    };
    while (left > 0) {
        std::string head(head_size, '\0');
        if (left < head_size || !file.read(head.data(), head_size)) refuse("ends too early");
        left -= head_size;
        std::uint8_t kind = 0;
        std::uint64_t size = 0;
        ArchiveReader start(head);
        start(kind, size);
        if (size > left) refuse("ends too early");
        content.resize(size);
        if (!file.read(content.data(), static_cast<std::streamsize>(size)))
            refuse("cannot be read");
        left -= size;
        ArchiveReader a(content);
        if (kind == static_cast<std::uint8_t>(Entry::sample)) {
            Sample sample;
            bool on_grid = false;
            a(sample, on_grid);
            visitor.sample(sample, on_grid);
        } else if (kind == static_cast<std::uint8_t>(Entry::frame)) {
            Frame frame;
            a(frame);
            visitor.frame(frame);
        } else {
            refuse("has an entry of an unknown kind");
        }
    }
}

}
