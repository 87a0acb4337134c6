// Nearest words and quoting for the messages of json_document.h.
#include "io/json_document.h"
#include "io/json_parse.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace sigmaflow::io {

namespace {

/// Edits (insert, remove, replace, swap neighbours) that turn one word into the other.
std::size_t edit_distance(std::string_view a, std::string_view b)
{
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replace = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replace});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

/// Upper case and dashes are the commonest slips: "Volume-Fraction".
std::string plain(std::string_view word)
{
    std::string result(word);
    for (char& c : result) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        if (c == '-' || c == ' ') c = '_';
    }
    return result;
}

}

std::string one_of(std::span<const std::string_view> words)
{
    std::string result;
    for (std::string_view word : words) result += (result.empty() ? "" : ", ") + std::string(word);
    return result;
}

std::optional<std::string> nearest_word(std::string_view word,
                                        std::span<const std::string_view> known)
{
    constexpr std::size_t longest = 64;  // keeps hostile keys cheap
    if (word.empty() || word.size() > longest) return std::nullopt;
    const std::string given = plain(word);
    std::optional<std::string> best;
    std::size_t best_distance = 3;
    for (std::string_view candidate : known) {
        const std::size_t distance = edit_distance(given, candidate);
        // two edits turn any word of two letters into any other
        if (distance < best_distance && distance < std::min(given.size(), candidate.size())) {
            best = candidate;
            best_distance = distance;
        }
    }
    if (best || given.size() < 3) return best;
    for (std::string_view candidate : known)
        if (candidate.starts_with(given) || (candidate.size() > 2 && given.starts_with(candidate)))
            return std::string(candidate);
    for (std::string_view candidate : known)  // "fraction" for "volume_fraction"
        if (candidate.ends_with("_" + given)) return std::string(candidate);
    return std::nullopt;
}

std::string number_text(double value)
{
    std::array<char, 32> buffer;  // the longest is -2.2250738585072014e-308
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return std::string(buffer.data(), result.ptr);
}

std::string in_quotes(std::string_view text, std::size_t longest)
{
    std::string result = "\"";
    for (char c : text.substr(0, longest)) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            result += {'\\', c};
        else if (c == '\n')
            result += "\\n";
        else if (byte < 0x20 || byte == 0x7F) {
            constexpr char digits[] = "0123456789abcdef";
            result += std::string("\\u00") + digits[byte >> 4] + digits[byte & 15];
        } else
            result += c;
    }
    if (text.size() > longest) {
        // do not end in the middle of a character
        while (result.size() > 1 && (static_cast<unsigned char>(result.back()) & 0xC0) == 0x80)
            result.pop_back();
        if (static_cast<unsigned char>(result.back()) >= 0xC0) result.pop_back();
        result += "...";
    }
    return result + "\"";
}

}
