// Films are read back by the reference decoder of Theora: every picture is there, in its place.
#include "render/movie.h"

#include "engine/error.h"
#include "render/ogg.h"
#include "render/particle_series.h"
#include "tests/render/scenes.h"
#include "tests/support/film_reader.h"

#include <gtest/gtest.h>
#include <cmath>
#include <filesystem>

using namespace sigmaflow;
using render::Image;

namespace {

std::filesystem::path scratch()
{
    return std::filesystem::path(testing::TempDir()) /
           ("film_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
}

/// A dark square at a place of its own on light ground.
Image picture(int number, int width, int height)
{
    Image image(width, height, {250, 240, 200});
    for (int row = 20; row < 44; ++row)
        for (int column = 8 + 10 * number; column < 32 + 10 * number; ++column) {
            image.pixel(column, row)[0] = 40;
            image.pixel(column, row)[1] = 60;
            image.pixel(column, row)[2] = 160;
        }
    return image;
}

std::string film_of(int pictures, int width, int height, int frames_per_second = 12)
{
    render::MovieWriter writer(scratch(), frames_per_second);
    for (int k = 0; k < pictures; ++k) writer.add(picture(k, width, height));
    return writer.finish();
}

/// Mean absolute difference of the values of the pixels that both have.
double difference(const Image& a, const Image& b)
{
    double sum = 0;
    const int width = std::min(a.width, b.width), height = std::min(a.height, b.height);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < 3 * width; ++column)
            sum += std::abs(a.pixel(0, row)[column] - b.pixel(0, row)[column]);
    return sum / (3. * width * height);
}

}

TEST(Movie, PlaysEveryPictureInItsPlace)
{
    const test::Film film = test::read_film(film_of(9, 160, 90, 24));
    EXPECT_EQ(film.width, 160);
    EXPECT_EQ(film.height, 90);
    EXPECT_DOUBLE_EQ(film.frames_per_second, 24);
    EXPECT_TRUE(film.ended);
    ASSERT_EQ(film.frames.size(), 9u);
    for (int k = 0; k < 9; ++k) {
        const double same = difference(film.frames[k], picture(k, 160, 90));
        EXPECT_LT(same, 3) << k;  // lossy
        EXPECT_GT(difference(film.frames[k], picture((k + 3) % 9, 160, 90)), 3 * same) << k;
    }
}

TEST(Movie, OddSizesGetAWhiteEdge)
{
    const test::Film film = test::read_film(film_of(2, 161, 91));
    EXPECT_EQ(film.width, 162);
    EXPECT_EQ(film.height, 92);
    ASSERT_EQ(film.frames.size(), 2u);
    EXPECT_LT(difference(film.frames[1], picture(1, 161, 91)), 3);
}

TEST(Movie, OnePictureIsAFilm)
{
    const test::Film film = test::read_film(film_of(1, 160, 90));
    EXPECT_EQ(film.frames.size(), 1u);
    EXPECT_TRUE(film.ended);
}

TEST(Movie, TheSamePicturesGiveTheSameBytes)
{
    EXPECT_EQ(film_of(3, 160, 90), film_of(3, 160, 90));
}

TEST(Movie, LeavesNoScratchFile)
{
    film_of(2, 160, 90);
    EXPECT_FALSE(std::filesystem::exists(scratch()));
}

TEST(Movie, ACutFilmIsNoFilm)
{
    std::string film = film_of(3, 160, 90);
    std::string same = film;
    EXPECT_TRUE(render::renumber_stream(same, 1));
    EXPECT_EQ(same, film);
    for (const std::size_t size : {film.size() - 1, film.size() / 2, std::size_t{10}}) {
        std::string cut = film.substr(0, size);
        EXPECT_FALSE(render::renumber_stream(cut, 1)) << size;
    }
}

TEST(Movie, RefusesWhatIsNoFilm)
{
    render::MovieWriter none(scratch(), 12);
    EXPECT_THROW(none.finish(), Error);
    render::MovieWriter sizes(scratch(), 12);
    sizes.add(picture(0, 160, 90));
    EXPECT_THROW(sizes.add(picture(0, 170, 90)), Error);
    render::MovieWriter nowhere("/no/such/folder/film", 12);
    EXPECT_THROW(nowhere.add(picture(0, 160, 90)), Error);
}

TEST(ParticleSeries, CoversTheValuesAndTheParticlesOfAllPictures)
{
    const auto near = test::polydata({{{1, 1, 1}, 1, 0.2}, {{10, 1, 1}, 1, 0.4}});
    const auto far = test::polydata({{{1, 1, 1}, 1, 0.2}, {{30, 1, 1}, 1, 3.7}});
    render::ParticleView own = test::bare_view(128, 64);
    own.colour_minimum.reset();
    own.colour_maximum.reset();
    render::ParticleSeries series(own);
    series.add(near, nullptr);
    series.add(far, nullptr);
    const render::ParticleView view = series.view();
    EXPECT_EQ(view.colour_minimum, 0);
    EXPECT_GE(*view.colour_maximum, 3.6);
    // a sphere that stays where it is stays where it is in the picture, in the same colour
    const Image first = render::render_particles(near, view);
    const Image second = render::render_particles(far, view);
    int dark = 0;
    ASSERT_EQ(first.height, second.height);
    for (int row = 0; row < first.height; ++row)
        for (int column = 0; column < 12; ++column)
            for (int c = 0; c < 3; ++c) {
                EXPECT_EQ(first.pixel(column, row)[c], second.pixel(column, row)[c]);
                dark += first.pixel(column, row)[c] < 200;
            }
    EXPECT_GT(dark, 20);
    EXPECT_GT(difference(first, second), 0.1);
}
