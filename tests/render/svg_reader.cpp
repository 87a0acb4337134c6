// tests/render/svg_reader.cpp
#include "tests/render/svg_reader.h"

#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>
#include <algorithm>
#include <sstream>

namespace sigmaflow::test {
namespace {

std::vector<render::Point> points_of(std::string text)
{
    for (char& letter : text)
        if (letter == 'M' || letter == 'Z' || letter == ',') letter = ' ';
    std::istringstream numbers(text);
    std::vector<render::Point> points;
    for (render::Point p; numbers >> p.x >> p.y;) points.push_back(p);
    return points;
}

void collect(vtkXMLDataElement* element, SvgFile& file)
{
    SvgElement found;
    for (int i = 0; i < element->GetNumberOfAttributes(); ++i)
        found.attributes[element->GetAttributeName(i)] = element->GetAttributeValue(i);
    const std::string name = element->GetName();
    if (name == "polyline") {
        found.points = points_of(found.attributes["points"]);
        file.polylines.push_back(found);
    } else if (name == "path") {
        found.points = points_of(found.attributes["d"]);
        (found.attributes.contains("aria-label") ? file.texts : file.areas).push_back(found);
    }
    for (int i = 0; i < element->GetNumberOfNestedElements(); ++i)
        collect(element->GetNestedElement(i), file);
}

}

render::Rectangle SvgElement::bounds() const
{
    render::Rectangle r{1e9, 1e9, -1e9, -1e9};
    for (const render::Point& p : points)
        r = {std::min(r.left, p.x), std::min(r.top, p.y), std::max(r.right, p.x),
             std::max(r.bottom, p.y)};
    return r;
}

std::vector<SvgElement> SvgFile::clipped_polylines() const
{
    std::vector<SvgElement> found;
    for (const SvgElement& line : polylines)
        if (line.attributes.contains("clip-path")) found.push_back(line);
    return found;
}

const SvgElement* SvgFile::text(const std::string& content) const
{
    for (const SvgElement& element : texts)
        if (element.attributes.at("aria-label") == content) return &element;
    return nullptr;
}

SvgFile read_svg(const std::string& text)
{
    SvgFile file;
    const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
        vtkXMLUtilities::ReadElementFromString(text.c_str()));
    if (!root || std::string(root->GetName()) != "svg") return file;
    file.well_formed = true;
    collect(root, file);
    return file;
}

}
