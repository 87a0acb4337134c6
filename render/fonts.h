// render/fonts.h -- letter shapes of the DejaVu fonts as outlines.
//
// DejaVu Sans for upright text and DejaVu Serif Italic for symbols: together they have all Greek
// letters, mathematical signs and combining dots that the labels need.
#pragma once
#include "render/drawing.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace sigmaflow::render {

enum class Face { upright, italic };

/// Outlines of a text for font size 1: origin at the left end of the base line, y downwards.
struct TextOutline {
    std::vector<Contour> contours;
    double advance = 0;  // where the next text starts
};

/// Where Linux distributions keep the DejaVu fonts.
std::vector<std::filesystem::path> usual_font_folders();

class Fonts {
public:
    /// Error: rendering, naming the package that has the missing font file.
    explicit Fonts(const std::vector<std::filesystem::path>& folders = usual_font_folders());
    ~Fonts();
    Fonts(const Fonts&) = delete;
    Fonts& operator=(const Fonts&) = delete;

    /// Letters that the face lacks are taken from the other one; bytes that are not UTF-8 are
    /// drawn as a replacement mark. A combining mark is centred above the letter before it.
    TextOutline outline(const std::string& utf8, Face face) const;

private:
    struct Library;
    std::unique_ptr<Library> library_;
};

/// Code points of a text; invalid bytes become U+FFFD.
std::u32string decode_utf8(const std::string& text);

}
