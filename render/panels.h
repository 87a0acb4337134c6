// render/panels.h -- pictures in rows and columns with letters (a), (b), ..., as in a paper.
//
// All columns are equally wide. A picture is scaled (image.h, resized) to the width of its column,
// but never to be higher than wide, and stands in the middle of its cell; a row is as high as its
// highest picture. Letters stand above the top left corner of each picture.
// Errors: rendering (no font).
#pragma once
#include "render/image.h"

#include <string>
#include <vector>

namespace sigmaflow::render {

struct Panel {
    Image picture;     // empty: none
    std::string note;  // rich text, stands in the place of a picture that is missing
};

struct PanelStyle {
    int columns = 2;
    int width = 2400;  // of the whole [pixels]
    bool letters = true;
};

/// Row by row from the top left; at most 26 with letters.
Image panels(const std::vector<Panel>& parts, const PanelStyle& style);

/// Width of a column [pixels].
int panel_width(const PanelStyle& style);

}
