#include "render/movie.h"

#include "engine/error.h"
#include "render/offscreen.h"
#include "render/ogg.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOggTheoraWriter.h>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

namespace sigmaflow::render {

namespace {

int even(int size)
{
    return size + size % 2;
}

/// VTK's first row is at the bottom.
vtkSmartPointer<vtkImageData> even_picture(const Image& image)
{
    Image whole(even(image.width), even(image.height));
    paste(whole, image, 0, 0);
    auto data = vtkSmartPointer<vtkImageData>::New();
    data->SetDimensions(whole.width, whole.height, 1);
    data->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int row = 0; row < whole.height; ++row)
        std::copy(
            whole.pixel(0, row), whole.pixel(0, row) + 3 * whole.width,
            static_cast<unsigned char*>(data->GetScalarPointer(0, whole.height - 1 - row, 0)));
    return data;
}

std::string content(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}

struct MovieWriter::Encoder {
    vtkNew<vtkOggTheoraWriter> writer;
    bool running = false;
};

MovieWriter::MovieWriter(std::filesystem::path scratch, int frames_per_second)
    : scratch_(std::move(scratch)), encoder_(std::make_unique<Encoder>())
{
    encoder_->writer->SetFileName(scratch_.c_str());
    encoder_->writer->SetRate(frames_per_second);
    encoder_->writer->SetQuality(2);  // the best of three
    encoder_->writer->SubsamplingOn();
}

MovieWriter::~MovieWriter()
{
    const VtkMessages silent;
    if (encoder_->running) encoder_->writer->End();
    std::error_code error;
    std::filesystem::remove(scratch_, error);
}

void MovieWriter::add(const Image& image)
{
    if (width_ == 0) {
        width_ = image.width;
        height_ = image.height;
    }
    if (image.width != width_ || image.height != height_)
        throw Error(ErrorKind::input, "movie",
                    "all pictures must have the size of the first one, " + std::to_string(width_) +
                        " x " + std::to_string(height_) + ", got " + std::to_string(image.width) +
                        " x " + std::to_string(image.height));
    const VtkMessages messages;
    const auto picture = even_picture(image);
    encoder_->writer->SetInputData(picture);
    if (!encoder_->running) encoder_->writer->Start();
    encoder_->running = true;
    encoder_->writer->Write();
    if (encoder_->writer->GetError())
        throw Error(ErrorKind::file, scratch_.string(), "the film cannot be written");
}

std::string MovieWriter::finish()
{
    if (!encoder_->running) throw Error(ErrorKind::input, "movie", "needs at least one picture");
    const VtkMessages messages;
    encoder_->writer->End();
    encoder_->running = false;
    std::string film = content(scratch_);
    if (film.empty() || !renumber_stream(film, 1))
        throw Error(ErrorKind::file, scratch_.string(),
                    "the film is incomplete, the disk may be full");
    return film;
}

}
