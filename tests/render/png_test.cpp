// tests/render/png_test.cpp
#include "engine/error.h"
#include "render/image.h"
#include "tests/support/image_compare.h"

#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <fstream>

using namespace sigmaflow;
using render::Image;
namespace fs = std::filesystem;

namespace {

Image colourful(int width, int height)
{
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        image.rgb[i] = static_cast<std::uint8_t>((i * i / 7 + 13 * i) % 256);
    return image;
}

class PngFile : public testing::Test {
protected:
    PngFile()
    {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::path(testing::TempDir()) / (std::string("sigmaflow_png_") + test->name());
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    ~PngFile() override { fs::remove_all(folder); }

    static void write(const fs::path& path, const Image& image)
    {
        std::ofstream(path, std::ios::binary) << render::png_bytes(image);
    }

    ErrorKind kind_of_reading(const fs::path& path)
    {
        try {
            render::read_png(path);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(path.filename()), std::string::npos);
            return error.kind();
        }
        return ErrorKind::internal;
    }

    fs::path folder;
};

}

TEST_F(PngFile, IsReadByAnotherReaderWithTheSamePixels)
{
    const Image image = colourful(37, 21);
    write(folder / "a.png", image);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName((folder / "a.png").c_str());
    reader->Update();
    vtkImageData* read = reader->GetOutput();
    ASSERT_EQ(read->GetDimensions()[0], 37);
    ASSERT_EQ(read->GetDimensions()[1], 21);
    for (int y = 0; y < 21; ++y)
        for (int x = 0; x < 37; ++x)
            for (int c = 0; c < 3; ++c)
                ASSERT_EQ(read->GetScalarComponentAsDouble(x, 20 - y, 0, c), image.pixel(x, y)[c]);
}

TEST_F(PngFile, IsReadBackByOurselves)
{
    const Image image = colourful(64, 5);
    write(folder / "a.png", image);
    const Image read = render::read_png(folder / "a.png");
    EXPECT_EQ(read.width, 64);
    EXPECT_EQ(read.rgb, image.rgb);
}

TEST_F(PngFile, HasTheSameBytesEveryTime)
{
    EXPECT_EQ(render::png_bytes(colourful(40, 30)), render::png_bytes(colourful(40, 30)));
}

TEST_F(PngFile, MissingForeignAndDamagedFilesAreToldApart)
{
    EXPECT_EQ(kind_of_reading(folder / "none.png"), ErrorKind::missing);
    std::ofstream(folder / "text.png") << "this is no picture";
    EXPECT_EQ(kind_of_reading(folder / "text.png"), ErrorKind::input);
    write(folder / "cut.png", colourful(50, 50));
    fs::resize_file(folder / "cut.png", fs::file_size(folder / "cut.png") / 2);
    EXPECT_EQ(kind_of_reading(folder / "cut.png"), ErrorKind::input);
}
