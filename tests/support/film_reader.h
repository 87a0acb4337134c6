// tests/support/film_reader.h -- an Ogg Theora film, read by the reference decoder (libtheora).
#pragma once
#include "render/image.h"

#include <string>
#include <vector>

namespace sigmaflow::test {

struct Film {
    int width = 0, height = 0;
    double frames_per_second = 0;
    bool ended = false;  // its last page is marked so
    std::vector<render::Image> frames;
};

/// Throws std::runtime_error for what is no such film. Pages with a wrong checksum are passed over
/// by libogg, so that their frames are missing.
Film read_film(const std::string& bytes);

}
