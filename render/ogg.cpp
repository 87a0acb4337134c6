#include "render/ogg.h"

#include <string_view>

namespace sigmaflow::render {

namespace {

// Places in the header of a page, RFC 3533 section 6.
constexpr std::size_t flags = 5, serial_number = 14, checksum = 22, segment_count = 26, header = 27;
constexpr unsigned char last_page = 4;

unsigned byte_at(std::string_view text, std::size_t place)
{
    return static_cast<unsigned char>(text[place]);
}

void put(std::string& text, std::size_t place, std::uint32_t value)
{
    for (int k = 0; k < 4; ++k) text[place + k] = static_cast<char>(value >> (8 * k) & 0xff);
}

/// Polynomial 0x04c11db7, no reflection, from 0 (RFC 3533 section 6, item 6).
std::uint32_t page_checksum(std::string_view page)
{
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < page.size(); ++k) {
        sum ^= byte_at(page, k) << 24;
        for (int bit = 0; bit < 8; ++bit) sum = (sum << 1) ^ (sum & 0x80000000u ? 0x04c11db7u : 0u);
    }
    return sum;
}

/// 0 if there is no whole page.
std::size_t page_size(std::string_view rest)
{
    if (rest.size() < header || !rest.starts_with("OggS")) return 0;
    std::size_t size = header + byte_at(rest, segment_count);
    if (rest.size() < size) return 0;
    for (std::size_t k = header, end = size; k < end; ++k) size += byte_at(rest, k);
    return rest.size() < size ? 0 : size;
}

}

bool renumber_stream(std::string& file, std::uint32_t number)
{
    bool complete = false;
    for (std::size_t from = 0; from < file.size();) {
        const std::size_t size = page_size(std::string_view(file).substr(from));
        if (size == 0) return false;
        complete = byte_at(file, from + flags) & last_page;
        put(file, from + serial_number, number);
        put(file, from + checksum, 0);
        put(file, from + checksum, page_checksum(std::string_view(file).substr(from, size)));
        from += size;
    }
    return complete;
}

}
