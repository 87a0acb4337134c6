// render/panels.cpp
#include "render/panels.h"

#include "render/rich_text.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace sigmaflow::render {
namespace {

constexpr double gap_share = 0.02, letter_share = 0.034, note_share = 0.03;  // of a column

int gap_of(const PanelStyle& style)
{
    return static_cast<int>(std::lround(gap_share * style.width / style.columns));
}

/// The size of a picture in a column; the places of missing ones are four to three.
Image fitted(const Image& picture, int column)
{
    if (picture.width == 0) return Image(column, std::max(1, 3 * column / 4));
    const double scale = std::min(static_cast<double>(column) / picture.width,
                                  static_cast<double>(column) / picture.height);
    const auto scaled = [&](int size) {
        return std::max(1, static_cast<int>(std::lround(scale * size)));
    };
    return resized(picture, scaled(picture.width), scaled(picture.height));
}

}

int panel_width(const PanelStyle& style)
{
    return std::max(1, (style.width - (style.columns - 1) * gap_of(style)) / style.columns);
}

Image panels(const std::vector<Panel>& parts, const PanelStyle& style)
{
    assert(!style.letters || parts.size() <= 26);
    const int column = panel_width(style), gap = gap_of(style);
    const double letter = letter_share * column;
    const int above = style.letters ? static_cast<int>(std::lround(1.4 * letter)) : 0;
    const auto columns = static_cast<std::size_t>(style.columns);

    std::vector<Image> pictures;
    for (const Panel& part : parts) pictures.push_back(fitted(part.picture, column));
    std::vector<int> heights((parts.size() + columns - 1) / columns);
    for (std::size_t k = 0; k < parts.size(); ++k)
        heights[k / columns] = std::max(heights[k / columns], above + pictures[k].height);
    const int gaps = gap * (static_cast<int>(heights.size()) - 1);
    Image whole(style.width, std::accumulate(heights.begin(), heights.end(), gaps));

    Drawing texts{whole.width, whole.height, {}};
    const Fonts fonts;
    int top = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (k > 0 && k % columns == 0) top += heights[k / columns - 1] + gap;
        const int left = static_cast<int>(k % columns) * (column + gap);
        const int room = heights[k / columns] - above - pictures[k].height;
        paste(whole, pictures[k], left + (column - pictures[k].width) / 2, top + above + room / 2);
        if (style.letters)
            draw_text(texts, fonts, std::string("(") + static_cast<char>('a' + k) + ")",
                      {left + 0.4 * letter, top + 1.1 * letter}, {.size = letter});
        if (parts[k].picture.width == 0)
            draw_text(texts, fonts, parts[k].note,
                      {left + 0.5 * column, top + above + 0.5 * (heights[k / columns] - above)},
                      {.size = note_share * column, .align = Align::centre});
    }
    rasterise(texts, whole);
    return whole;
}

}
