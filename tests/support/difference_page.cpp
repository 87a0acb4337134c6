// tests/support/difference_page.cpp
#include "tests/support/difference_page.h"

#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

namespace sigmaflow::test {

namespace fs = std::filesystem;
using render::Image;

namespace {

std::string base64(const std::string& bytes)
{
    const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        unsigned group = 0;
        for (std::size_t j = 0; j < 3; ++j)
            group =
                group << 8 | (k + j < bytes.size() ? static_cast<unsigned char>(bytes[k + j]) : 0u);
        for (std::size_t j = 0; j < 4; ++j)
            text += k + j > bytes.size() ? '=' : letters[group >> (18 - 6 * j) & 63];
    }
    return text;
}

std::string escaped(const std::string& text)
{
    std::string result;
    for (char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else if (c == '"')
            result += "&quot;";
        else
            result += c;
    }
    return result;
}

std::string cell(const std::string& title, const Image& image)
{
    return "<td><img alt=\"" + escaped(title) + "\" src=\"data:image/png;base64," +
           base64(render::png_bytes(image)) + "\"/></td>\n";
}

std::string row(const Difference& found, const fs::path& drawn)
{
    const bool comparable = found.baseline && found.baseline->width == found.drawn.width &&
                            found.baseline->height == found.drawn.height;
    std::string text = "<tr id=\"" + escaped(found.name) + "\">\n<th>" + escaped(found.name) +
                       "<p>" + escaped(found.reason) + "</p></th>\n";
    text += found.baseline ? cell(found.name + " baseline", *found.baseline)
                           : std::string("<td>none</td>\n");
    text += cell(found.name + " drawn", found.drawn);
    text += comparable
                ? cell(found.name + " difference", difference_of(*found.baseline, found.drawn))
                : std::string("<td>nothing to compare</td>\n");
    char score[96];
    std::snprintf(score, sizeof score, "<td>%.4f<p>at least %.4f</p></td>\n", found.score,
                  found.least);
    return text + score + "<td><code>cp " + escaped(drawn.string()) + " " +
           escaped(found.accepted.string()) + "</code></td>\n</tr>\n";
}

std::string text_of(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Whole or not at all: tests run side by side.
void write_whole(const fs::path& path, const std::string& text)
{
    const fs::path temporary = path.string() + "." + std::to_string(getpid());
    std::ofstream(temporary, std::ios::binary) << text;
    fs::rename(temporary, path);
}

void write_page(const fs::path& folder)
{
    std::vector<fs::path> rows;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".row") rows.push_back(entry.path());
    if (rows.empty()) {
        fs::remove(folder / page_name);
        return;
    }
    std::sort(rows.begin(), rows.end());
    std::string page = R"(<!DOCTYPE html>
<html xmlns="http://www.w3.org/1999/xhtml" lang="en"><head><meta charset="utf-8"/>
<title>pictures that differ</title>
<style>
body { font: 15px sans-serif; margin: 2em }
th, td { padding: 0.6em; border-bottom: 1px solid #bbb; vertical-align: top; text-align: left }
img { border: 1px solid #ddd; max-width: 24em }
p { font-weight: normal; color: #555 }
code { overflow-wrap: anywhere }
</style></head><body>
<h1>)" + std::to_string(rows.size()) +
                       R"( pictures differ from their baselines</h1>
<p>A drawn picture that is right becomes the baseline by the command in its row.</p>
<table><thead><tr><th>picture</th><th>baseline</th><th>drawn</th><th>difference</th><th>similarity</th>
<th>to accept it</th></tr></thead><tbody>
)";
    for (const fs::path& path : rows) page += text_of(path);
    write_whole(folder / page_name, page + "</tbody></table></body></html>\n");
}

}

Image difference_of(const Image& a, const Image& b)
{
    Image result(a.width, a.height);
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            int most = 0;
            for (int c = 0; c < 3; ++c)
                most = std::max(most, std::abs(a.pixel(x, y)[c] - b.pixel(x, y)[c]));
            const int light = std::max(0, 255 - 3 * most);
            result.pixel(x, y)[1] = result.pixel(x, y)[2] = static_cast<std::uint8_t>(light);
        }
    return result;
}

fs::path add_difference(const fs::path& folder, const Difference& found)
{
    fs::create_directories(folder);
    const fs::path drawn = folder / (found.name + ".png");
    write_whole(drawn, render::png_bytes(found.drawn));
    write_whole(folder / (found.name + ".row"), row(found, drawn));
    write_page(folder);
    return drawn;
}

void remove_difference(const fs::path& folder, const std::string& name)
{
    if (!fs::remove(folder / (name + ".row"))) return;
    fs::remove(folder / (name + ".png"));
    write_page(folder);
}

}
