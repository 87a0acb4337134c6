// tests/fuzz/fuzzing.h -- what counts as a finding.
//
// A reader may do two things with any bytes: accept them, or throw Error(input) with a message that
// names the place and can be printed. Every other exception leaves the fuzzer, which then stops and
// keeps the bytes; so does a promise that does not hold.
#pragma once
#include "engine/error.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace sigmaflow::fuzzing {

inline void promise(bool holds, const char* what)
{
    if (holds) return;
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
}

/// No control characters, and UTF-8.
inline bool is_printable(const std::string& text)
{
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
    if (std::any_of(text.begin(), text.end(), is_control)) return false;
    const auto ignore = nlohmann::json::error_handler_t::ignore;
    const std::string kept = nlohmann::json(text).dump(-1, ' ', false, ignore);
    return nlohmann::json::parse(kept).get<std::string>() == text;
}

/// What `read` makes of the bytes of `file`, nothing if it refuses them.
template <class Read>
auto accepted(const std::string& file, const Read& read) -> std::optional<decltype(read())>
{
    try {
        return read();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) throw;
        const std::string message = error.what();
        promise(message.starts_with(file + ":"), "a refusal names the place");
        promise(is_printable(message), "a refusal can be printed");
        return std::nullopt;
    }
}

inline std::string as_text(const std::uint8_t* bytes, std::size_t count)
{
    return {reinterpret_cast<const char*>(bytes), count};
}

}
