// tests/support/similarity.h -- are two pictures the same, to the eye and to the byte?
#pragma once
#include "render/image.h"

namespace sigmaflow::test {

/// Mean structural similarity in [-1, 1] of two pictures of equal size, 1 for identical ones
/// (Wang, Bovik, Sheikh, Simoncelli, IEEE Trans. Image Process. 13, 600, 2004): windows of 8 x 8
/// pixels every 4 pixels, the three colours averaged, constants 0.01 and 0.03 as in the source.
double similarity(const render::Image& a, const render::Image& b);

/// Largest difference of a colour channel, 0..255. Pictures of equal size.
int largest_difference(const render::Image& a, const render::Image& b);

/// Share of the pixels that differ from the most frequent colour: 0 for an empty picture.
double drawn_share(const render::Image& image);

}
