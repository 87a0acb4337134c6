// render/rich_text.cpp
#include "render/rich_text.h"

#include <cmath>

namespace sigmaflow::render {
namespace {

constexpr double script_size = 0.70, drop = 0.18, rise = 0.38;

TextOutline rich_outline(const Fonts& fonts, const std::string& rich)
{
    TextOutline line;
    for (const TextRun& run : parse_rich_text(rich)) {
        const double size = run.script == Script::normal ? 1.0 : script_size;
        const double shift = run.script == Script::below   ? drop
                             : run.script == Script::above ? -rise
                                                           : 0.0;
        TextOutline part = fonts.outline(run.text, run.face);
        for (Contour& contour : part.contours) {
            for (Point& p : contour) p = {line.advance + size * p.x, shift + size * p.y};
            line.contours.push_back(std::move(contour));
        }
        line.advance += size * part.advance;
    }
    return line;
}

}

std::vector<TextRun> parse_rich_text(const std::string& text)
{
    std::vector<TextRun> runs;
    TextRun run;
    const auto finish = [&] {
        if (!run.text.empty()) runs.push_back(run);
        run.text.clear();
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char letter = text[i];
        const bool opens = (letter == '_' || letter == '^') && text.substr(i + 1, 1) == "{";
        if (letter == '$') {
            finish();
            run.face = run.face == Face::italic ? Face::upright : Face::italic;
        } else if (opens && run.script == Script::normal) {
            finish();
            run.script = letter == '_' ? Script::below : Script::above;
            ++i;
        } else if (letter == '}' && run.script != Script::normal) {
            finish();
            run.script = Script::normal;
        } else {
            run.text += letter;
        }
    }
    finish();
    return runs;
}

std::string plain_text(const std::string& rich)
{
    std::string plain;
    for (const TextRun& run : parse_rich_text(rich)) plain += run.text;
    return plain;
}

double text_width(const Fonts& fonts, const std::string& rich)
{
    return rich_outline(fonts, rich).advance;
}

void draw_text(Drawing& drawing, const Fonts& fonts, const std::string& rich, Point at,
               const TextStyle& style)
{
    TextOutline line = rich_outline(fonts, rich);
    const double share = style.align == Align::left     ? 0.0
                         : style.align == Align::centre ? 0.5
                                                        : 1.0;
    const double start = -share * line.advance * style.size;
    // A base line on whole pixels keeps the feet of the letters sharp.
    if (style.upwards)
        at.x = std::round(at.x);
    else
        at.y = std::round(at.y);
    for (Contour& contour : line.contours) {
        for (Point& p : contour) {
            const double along = start + style.size * p.x, down = style.size * p.y;
            p = style.upwards ? Point{at.x + down, at.y - along} : Point{at.x + along, at.y + down};
        }
    }
    if (!line.contours.empty())
        drawing.fill({std::move(line.contours), style.ink, plain_text(rich)});
}

}
