// tests/render/svg_reader.h -- what is in an SVG file, read with VTK's XML parser (expat).
#pragma once
#include "render/drawing.h"

#include <map>
#include <string>
#include <vector>

namespace sigmaflow::test {

struct SvgElement {
    std::map<std::string, std::string> attributes;
    std::vector<render::Point> points;  // of a polyline or a path

    render::Rectangle bounds() const;
};

struct SvgFile {
    bool well_formed = false;
    std::vector<SvgElement> polylines, texts, areas;

    /// Lines of data are cut at the frame, the frame itself and its ticks are not.
    std::vector<SvgElement> clipped_polylines() const;
    const SvgElement* text(const std::string& content) const;  // null: not there
};

SvgFile read_svg(const std::string& text);

}
