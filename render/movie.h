// render/movie.h -- pictures one after another as a film: Ogg Theora, the free format of browsers
// and players.
//
// VTK's writer (vtkOggTheoraWriter) compresses; what it leaves to chance or does not report is made
// good here: the number of the stream is always 1, so that the same pictures give the same bytes,
// and the pages of the finished film are read again, so that one that was cut off (full disk) is an
// error. Half the resolution for colours (4:2:0), which every player knows; an odd width or height
// gets a white column or row.
// Errors: file (cannot be written or is incomplete), input (no pictures, or of different sizes).
#pragma once
#include "render/image.h"

#include <filesystem>
#include <memory>
#include <string>

namespace sigmaflow::render {

class MovieWriter {
public:
    /// Compresses into `scratch`, a file that is gone when the writer is; `frames_per_second` in
    /// [1, 240].
    MovieWriter(std::filesystem::path scratch, int frames_per_second);
    ~MovieWriter();

    void add(const Image& image);
    /// The film as an .ogv file. Nothing can be added afterwards.
    std::string finish();

private:
    struct Encoder;
    std::filesystem::path scratch_;
    int width_ = 0, height_ = 0;  // of the pictures, before anything is added to them
    std::unique_ptr<Encoder> encoder_;
};

}
