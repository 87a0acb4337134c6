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

void visit_entry(const std::filesystem::path& path, std::uint8_t kind, const std::string& content,
                 const JournalVisitor& visitor)
{
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
        throw Error(ErrorKind::input, path.string(), "has an entry of an unknown kind");
    }
}

/// One entry after the other; `at_cut` is called where the last one ends too early.
void read_entries(const std::filesystem::path& path, const JournalVisitor& visitor,
                  const std::function<void()>& at_cut)
{
    std::error_code unknown;
    std::uint64_t left = std::filesystem::file_size(path, unknown);
    std::ifstream file(path, std::ios::binary);
    if (unknown || !file) throw Error(ErrorKind::missing, path.string(), "cannot be read");
    constexpr std::size_t head_size = sizeof(std::uint8_t) + sizeof(std::uint64_t);
    std::string content;
    while (left > 0) {
        std::string head(head_size, '\0');
        if (left < head_size || !file.read(head.data(), head_size)) return at_cut();
        left -= head_size;
        std::uint8_t kind = 0;
        std::uint64_t size = 0;
        ArchiveReader start(head);
        start(kind, size);
        if (size > left) return at_cut();
        content.resize(size);
        if (!file.read(content.data(), static_cast<std::streamsize>(size)))
            throw Error(ErrorKind::input, path.string(), "cannot be read");
        left -= size;
        visit_entry(path, kind, content, visitor);
    }
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
    read_entries(path, visitor,
                 [&] { throw Error(ErrorKind::input, path.string(), "ends too early"); });
}

void read_journal_so_far(const std::filesystem::path& path, const JournalVisitor& visitor)
{
    read_entries(path, visitor, [] {});
}

}
