#include "workflows/html.h"

#include <algorithm>
#include <cstdint>

namespace sigmaflow::workflows::html {

namespace {

constexpr const char* replacement_mark = "\xEF\xBF\xBD";

// Wide tables scroll inside their box; what is folded is not printed, a sweep would fill a book.
constexpr const char* style = R"(
body { font: 1rem/1.5 system-ui, sans-serif; color: #1a1a1f; background: #fff; max-width: 62rem;
  margin: 0 auto; padding: 1rem; overflow-wrap: anywhere; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0.5rem 0; }
h2 { font-size: 1.3rem; margin: 2.2rem 0 0.6rem; border-bottom: 1px solid #ccc; }
h3 { font-size: 1.1rem; margin: 1.8rem 0 0.4rem; }
a { color: #0b57a4; }
.kind, figcaption, .note { color: #5b5b66; font-weight: normal; font-size: 0.9rem; }
.status { padding: 0.4rem 0.8rem; border-left: 0.4rem solid #b36b00; background: #fdf4e3; }
.complete { border-color: #2b7a3d; background: #edf7ef; }
.failed { border-color: #b3261e; background: #fcebea; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 0.5rem 0 1rem; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: 0.15rem 0.9rem 0.15rem 0;
  border-bottom: 1px solid #e4e4e8; overflow-wrap: normal; }
thead th { border-bottom: 1px solid #888; }
.bar { background: #7f9fc4; height: 0.9rem; margin-top: 0.3rem; min-width: 1px; }
data { white-space: nowrap; }
figure { margin: 0.8rem 0; break-inside: avoid; }
img { max-width: 100%; height: auto; display: block; }
details { margin: 0.4rem 0; }
summary { cursor: pointer; color: #0b57a4; }
pre { overflow-x: auto; font-size: 0.8rem; background: #f6f6f8; padding: 0.6rem; }
ul { padding-left: 1.3rem; margin: 0.3rem 0; }
@media print { body { max-width: none; padding: 0; font-size: 0.8rem; }
  .wide, pre { overflow: visible; } pre { white-space: pre-wrap; } h2, h3 { break-after: avoid; }
  figure img { max-height: 22cm; } }
)";

bool is_unreserved(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-._~/").find(c) != std::string_view::npos;
}

}

std::string escaped(std::string_view text)
{
    std::string safe;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        const std::string_view three = text.substr(k, 3);
        if (c == '&')
            safe += "&amp;";
        else if (c == '<')
            safe += "&lt;";
        else if (c == '>')
            safe += "&gt;";
        else if (c == '"')
            safe += "&quot;";
        else if (c == '\'')
            safe += "&#39;";
        else if ((static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7f)
            safe += replacement_mark;
        else if (three == "\xEF\xBF\xBE" || three == "\xEF\xBF\xBF") {
            safe += replacement_mark;
            k += 2;
        } else
            safe += c;
    }
    return safe;
}

std::string link(std::string_view path)
{
    constexpr const char* digits = "0123456789ABCDEF";
    std::string address;
    for (char c : path) {
        if (is_unreserved(c)) {
            address += c;
            continue;
        }
        const auto byte = static_cast<unsigned char>(c);
        address += {'%', digits[byte >> 4], digits[byte & 15]};
    }
    return address;
}

std::string base64(std::string_view bytes)
{
    constexpr const char* letters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
        std::uint32_t three = 0;
        for (std::size_t i = 0; i < 3; ++i)
            three = three << 8 | (i < count ? static_cast<unsigned char>(bytes[k + i]) : 0u);
        for (std::size_t i = 0; i < 4; ++i)
            text += i <= count ? letters[three >> (18 - 6 * i) & 63] : '=';
    }
    return text;
}

std::string element(std::string_view name, std::string_view content, std::string_view attributes)
{
    std::string text = "<";
    text += name;
    if (!attributes.empty()) text.append(" ").append(attributes);
    text.append(">").append(content).append("</").append(name).append(">");
    return text;
}

std::string table(const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& rows)
{
    std::string cells, body;
    for (const std::string& cell : head) cells += element("th", cell, "scope=\"col\"");
    const std::string thead = head.empty() ? "" : element("thead", element("tr", cells)) + "\n";
    for (const std::vector<std::string>& row : rows) {
        cells.clear();
        for (const std::string& cell : row) cells += element("td", cell);
        body += element("tr", cells) + "\n";
    }
    return element("div", element("table", thead + element("tbody", "\n" + body)),
                   "class=\"wide\"") +
           "\n";
}

std::string details(std::string_view summary, std::string_view content, std::string_view attributes)
{
    return element("details", element("summary", summary) + "\n" + std::string(content),
                   attributes) +
           "\n";
}

std::string page(std::string_view title, std::string_view body)
{
    std::string text =
        "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n"
        "<meta charset=\"utf-8\"/>\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
    text += element("title", title) + "\n" + element("style", style) + "\n</head>\n<body>\n";
    return text.append(body).append("</body>\n</html>\n");
}

}
