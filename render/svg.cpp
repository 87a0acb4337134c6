// render/svg.cpp -- a drawing as an SVG file: lines as <polyline>, texts and areas as <path>.
#include "render/drawing.h"

#include <cstdio>
#include <map>
#include <tuple>

namespace sigmaflow::render {
namespace {

/// At most two decimals, no trailing zeros, always with a decimal point whatever the locale.
std::string number(double value)
{
    const long long hundredths = static_cast<long long>(value * 100 + (value < 0 ? -0.5 : 0.5));
    const unsigned long long size = hundredths < 0 ? -hundredths : hundredths;
    std::string text = hundredths < 0 ? "-" : "";
    text += std::to_string(size / 100);
    if (size % 100 != 0) {
        text += '.';
        text += static_cast<char>('0' + size % 100 / 10);
        if (size % 10 != 0) text += static_cast<char>('0' + size % 10);
    }
    return text;
}

std::string escaped(const std::string& text)
{
    std::string safe;
    for (char letter : text) {
        if (letter == '&')
            safe += "&amp;";
        else if (letter == '<')
            safe += "&lt;";
        else if (letter == '>')
            safe += "&gt;";
        else if (letter == '"')
            safe += "&quot;";
        else if (static_cast<unsigned char>(letter) < 0x20)
            safe += ' ';
        else
            safe += letter;
    }
    return safe;
}

std::string colour_text(const Colour& colour)
{
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0] & 255, colour[1] & 255,
                  colour[2] & 255);
    return text;
}

std::string points_text(const Contour& points)
{
    std::string text;
    for (const Point& p : points) {
        if (!text.empty()) text += ' ';
        text += number(p.x);
        text += ',';
        text += number(p.y);
    }
    return text;
}

std::string opacity_text(const char* attribute, const Ink& ink)
{
    if (ink.opacity >= 1) return {};
    return std::string(" ") + attribute + "=\"" + number(ink.opacity) + "\"";
}

std::string fill_element(const Fill& fill, const std::string& clip)
{
    std::string path;
    for (const Contour& contour : fill.contours) {
        if (contour.empty()) continue;
        path += 'M';
        path += points_text(contour);
        path += 'Z';
    }
    std::string element = "<path";
    if (!fill.text.empty())
        element += " class=\"text\" role=\"img\" aria-label=\"" + escaped(fill.text) + "\"";
    return element + clip + " fill=\"" + colour_text(fill.ink.colour) + "\"" +
           opacity_text("fill-opacity", fill.ink) + " d=\"" + path + "\"/>\n";
}

std::string stroke_element(const Stroke& stroke, const std::string& clip)
{
    std::string element = "<polyline" + clip + " fill=\"none\" stroke=\"" +
                          colour_text(stroke.ink.colour) + "\"" +
                          opacity_text("stroke-opacity", stroke.ink) + " stroke-width=\"" +
                          number(stroke.width) + "\" stroke-linejoin=\"round\"";
    if (stroke.round) element += " stroke-linecap=\"round\"";
    if (!stroke.dashes.empty()) {
        std::string lengths;
        for (double length : stroke.dashes) {
            if (!lengths.empty()) lengths += ' ';
            lengths += number(length);
        }
        element += " stroke-dasharray=\"" + lengths + "\"";
    }
    return element + " points=\"" + points_text(stroke.points) + "\"/>\n";
}

/// One <clipPath> for every distinct clip rectangle.
class Clips {
public:
    std::string attribute(const std::optional<Rectangle>& clip)
    {
        if (!clip) return {};
        const auto key = std::tuple(clip->left, clip->top, clip->width(), clip->height());
        const auto [entry, is_new] = numbers_.try_emplace(key, numbers_.size());
        const std::string name = "clip" + std::to_string(entry->second);
        if (is_new)
            definitions_ += "<clipPath id=\"" + name + "\"><rect x=\"" + number(clip->left) +
                            "\" y=\"" + number(clip->top) + "\" width=\"" + number(clip->width()) +
                            "\" height=\"" + number(clip->height()) + "\"/></clipPath>\n";
        return " clip-path=\"url(#" + name + ")\"";
    }
    std::string definitions() const
    {
        return definitions_.empty() ? "" : "<defs>\n" + definitions_ + "</defs>\n";
    }

private:
    std::map<std::tuple<double, double, double, double>, std::size_t> numbers_;
    std::string definitions_;
};

}

std::string svg_text(const Drawing& drawing)
{
    Clips clips;
    std::string body;
    for (const Shape& shape : drawing.shapes) {
        const std::string clip = clips.attribute(shape.clip);
        if (const Fill* fill = std::get_if<Fill>(&shape.form))
            body += fill_element(*fill, clip);
        else
            body += stroke_element(std::get<Stroke>(shape.form), clip);
    }
    const std::string size = "width=\"" + std::to_string(drawing.width) + "\" height=\"" +
                             std::to_string(drawing.height) + "\"";
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
           "version=\"1.1\" " +
           size + " viewBox=\"0 0 " + std::to_string(drawing.width) + " " +
           std::to_string(drawing.height) + "\">\n" + clips.definitions() + "<rect " + size +
           " fill=\"#ffffff\"/>\n" + body + "</svg>\n";
}

}
