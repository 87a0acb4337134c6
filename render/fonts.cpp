// render/fonts.cpp
#include "render/fonts.h"

#include "engine/error.h"

#include <ft2build.h>
#include <algorithm>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

namespace sigmaflow::render {

struct Fonts::Library {
    FT_Library freetype = nullptr;
    FT_Face upright = nullptr, italic = nullptr;

    ~Library()
    {
        if (freetype) FT_Done_FreeType(freetype);  // closes its faces, too
    }
};

namespace {

constexpr int steps_per_curve = 6;

struct Extent {
    double left = 1e9, right = -1e9, top = 1e9;
};

Extent extent(const std::vector<Contour>& contours)
{
    Extent result;
    for (const Contour& contour : contours) {
        for (const Point& p : contour) {
            result.left = std::min(result.left, p.x);
            result.right = std::max(result.right, p.x);
            result.top = std::min(result.top, p.y);
        }
    }
    return result;
}

/// Receives FreeType's lines and curves; y is turned downwards.
struct Collector {
    std::vector<Contour> contours;
    double scale;

    Point point(const FT_Vector* v) const { return {scale * v->x, -scale * v->y}; }

    static int move_to(const FT_Vector* to, void* self)
    {
        auto& c = *static_cast<Collector*>(self);
        c.contours.push_back({c.point(to)});
        return 0;
    }
    static int line_to(const FT_Vector* to, void* self)
    {
        auto& c = *static_cast<Collector*>(self);
        c.contours.back().push_back(c.point(to));
        return 0;
    }
    static int conic_to(const FT_Vector* control, const FT_Vector* to, void* self)
    {
        auto& c = *static_cast<Collector*>(self);
        const Point a = c.contours.back().back(), b = c.point(control), d = c.point(to);
        for (int i = 1; i <= steps_per_curve; ++i) {
            const double t = double(i) / steps_per_curve, s = 1 - t;
            c.contours.back().push_back({s * s * a.x + 2 * s * t * b.x + t * t * d.x,
                                         s * s * a.y + 2 * s * t * b.y + t * t * d.y});
        }
        return 0;
    }
    static int cubic_to(const FT_Vector*, const FT_Vector*, const FT_Vector* to, void* self)
    {
        return line_to(to, self);  // TrueType fonts such as DejaVu have no cubic curves
    }
};

TextOutline glyph_outline(FT_Face face, FT_UInt glyph)
{
    if (FT_Load_Glyph(face, glyph, FT_LOAD_NO_SCALE)) return {};
    Collector collector{{}, 1.0 / face->units_per_EM};
    FT_Outline_Funcs receivers{
        Collector::move_to, Collector::line_to, Collector::conic_to, Collector::cubic_to, 0, 0};
    FT_Outline_Decompose(&face->glyph->outline, &receivers, &collector);
    return {std::move(collector.contours), face->glyph->metrics.horiAdvance * collector.scale};
}

void move(std::vector<Contour>& contours, double dx, double dy)
{
    for (Contour& contour : contours) {
        for (Point& p : contour) {
            p.x += dx;
            p.y += dy;
        }
    }
}

bool is_combining(char32_t letter)
{
    return letter >= 0x300 && letter <= 0x36f;
}

/// The fonts place marks with tables that FreeType does not read, so they are centred here.
void place_mark(std::vector<Contour>& mark, const Extent& base)
{
    constexpr double clearance = 0.07, slant = 0.06;
    const Extent own = extent(mark);
    double bottom = -1e9;
    for (const Contour& contour : mark)
        for (const Point& p : contour) bottom = std::max(bottom, p.y);
    move(mark, (base.left + base.right) / 2 - (own.left + own.right) / 2 + slant / 2,
         base.top - clearance - bottom);
}

FT_Face open_face(FT_Library freetype, const std::vector<std::filesystem::path>& folders,
                  const std::string& file, const std::string& package)
{
    for (const auto& folder : folders) {
        FT_Face face = nullptr;
        if (FT_New_Face(freetype, (folder / file).c_str(), 0, &face) == 0) return face;
    }
    throw Error(ErrorKind::rendering, "fonts",
                "the font " + file + " is missing; install the package " + package);
}

}

std::vector<std::filesystem::path> usual_font_folders()
{
    return {"/usr/share/fonts/truetype/dejavu",
            "/usr/share/fonts/dejavu",
            "/usr/share/fonts/dejavu-sans-fonts",
            "/usr/share/fonts/dejavu-serif-fonts",
            "/usr/share/fonts/TTF",
            "/usr/local/share/fonts/dejavu"};
}

Fonts::Fonts(const std::vector<std::filesystem::path>& folders)
    : library_(std::make_unique<Library>())
{
    if (FT_Init_FreeType(&library_->freetype))
        throw Error(ErrorKind::rendering, "fonts", "the FreeType library does not start");
    library_->upright =
        open_face(library_->freetype, folders, "DejaVuSans.ttf", "fonts-dejavu-core");
    library_->italic =
        open_face(library_->freetype, folders, "DejaVuSerif-Italic.ttf", "fonts-dejavu-extra");
}

Fonts::~Fonts() = default;

TextOutline Fonts::outline(const std::string& utf8, Face wanted) const
{
    const FT_Face preferred = wanted == Face::italic ? library_->italic : library_->upright;
    const FT_Face other = wanted == Face::italic ? library_->upright : library_->italic;
    TextOutline result;
    Extent base;
    FT_Face last_face = nullptr;
    FT_UInt last_glyph = 0;
    for (const char32_t letter : decode_utf8(utf8)) {
        const bool use_other =
            FT_Get_Char_Index(preferred, letter) == 0 && FT_Get_Char_Index(other, letter) != 0;
        const FT_Face face = use_other ? other : preferred;
        const FT_UInt glyph = FT_Get_Char_Index(face, letter);
        TextOutline shape = glyph_outline(face, glyph);
        if (is_combining(letter) && base.right > base.left) {
            place_mark(shape.contours, base);
            shape.advance = 0;
        } else {
            FT_Vector kerning{0, 0};
            if (face == last_face)
                FT_Get_Kerning(face, last_glyph, glyph, FT_KERNING_UNSCALED, &kerning);
            result.advance += double(kerning.x) / face->units_per_EM;
            move(shape.contours, result.advance, 0);
            base = extent(shape.contours);
            last_face = face;
            last_glyph = glyph;
        }
        result.advance += shape.advance;
        for (Contour& contour : shape.contours) result.contours.push_back(std::move(contour));
    }
    return result;
}

std::u32string decode_utf8(const std::string& text)
{
    std::u32string letters;
    for (std::size_t i = 0; i < text.size();) {
        const auto first = static_cast<unsigned char>(text[i++]);
        const int more = first < 0x80       ? 0
                         : first >> 5 == 6  ? 1
                         : first >> 4 == 14 ? 2
                         : first >> 3 == 30 ? 3
                                            : -1;
        if (more < 0) {
            letters += U'\uFFFD';
            continue;
        }
        char32_t letter = more == 0 ? first : first & (0x3f >> more);
        int read = 0;
        while (read < more && i < text.size() &&
               (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80) {
            letter = letter << 6 | (static_cast<unsigned char>(text[i++]) & 0x3f);
            ++read;
        }
        letters += read == more ? letter : U'\uFFFD';
    }
    return letters;
}

}
