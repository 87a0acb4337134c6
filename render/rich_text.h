// render/rich_text.h -- texts with italic symbols, subscripts and superscripts.
//
//   $italic$   _{subscript}   ^{superscript}
// Italic may be switched inside a script; scripts do not nest. A single $, or _{ without }, holds
// to the end of the text. Minus signs in front of numbers are the caller's: use U+2212.
#pragma once
#include "render/drawing.h"
#include "render/fonts.h"

#include <string>
#include <vector>

namespace sigmaflow::render {

enum class Script { normal, below, above };

struct TextRun {
    std::string text;
    Face face = Face::upright;
    Script script = Script::normal;

    bool operator==(const TextRun&) const = default;
};

std::vector<TextRun> parse_rich_text(const std::string& text);

/// The text without any mark-up.
std::string plain_text(const std::string& rich);

enum class Align { left, centre, right };

struct TextStyle {
    double size = 30;  // height of the font [pixels]
    Align align = Align::left;
    Ink ink{{13, 13, 18}, 1};
    bool upwards = false;  // reads from bottom to top
};

/// Adds a text to a drawing; `at` is on its base line, at the end or middle that `align` says.
void draw_text(Drawing& drawing, const Fonts& fonts, const std::string& rich, Point at,
               const TextStyle& style);

/// Width of a text at font size 1.
double text_width(const Fonts& fonts, const std::string& rich);

/// Height of the capital letters, and of the lower case letters, at font size 1.
inline constexpr double capital_height = 0.73, small_height = 0.55;

}
