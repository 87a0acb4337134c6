// tests/render/chains_test.cpp -- facts about pictures of strong contacts that no driver may
// change.
#include "engine/error.h"
#include "render/particles.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <algorithm>
#include <cmath>

using namespace sigmaflow;
using render::Image;

namespace {

/// Two upright pairs, one on the left and one on the right; the forces of their contacts.
struct Pairs {
    vtkSmartPointer<vtkPolyData> particles, contacts;
};

Pairs pairs(double left, double right)
{
    Pairs result;
    result.particles = test::polydata(
        {{{0, 0, 0}, 1, 0}, {{0, 2, 0}, 1, 0}, {{8, 0, 0}, 1, 0}, {{8, 2, 0}, 1, 0}});
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkDoubleArray> forces;
    forces->SetName("normal_force");
    for (const auto& [x, force] : {std::pair(0., left), std::pair(8., right)}) {
        const vtkIdType ends[2] = {points->InsertNextPoint(x, 0, 0),
                                   points->InsertNextPoint(x, 2, 0)};
        lines->InsertNextCell(2, ends);
        forces->InsertNextValue(force);
    }
    result.contacts = vtkSmartPointer<vtkPolyData>::New();
    result.contacts->SetPoints(points);
    result.contacts->SetLines(lines);
    result.contacts->GetCellData()->AddArray(forces);
    return result;
}

/// Pixels that are neither white nor grey, in the left and in the right half.
struct Coloured {
    int left = 0, right = 0;
};

Coloured drawn(double left, double right, double largest)
{
    render::ParticleView view = test::bare_view(600, 300);
    view.colour_by = "normal_force";
    view.colour_maximum = largest;
    const Pairs scene = pairs(left, right);
    const Image image = render::render_chains(scene.particles, scene.contacts, view);
    Coloured count;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column) {
            const std::uint8_t* p = image.pixel(column, row);
            if (*std::max_element(p, p + 3) - *std::min_element(p, p + 3) < 40) continue;
            (column < image.width / 2 ? count.left : count.right) += 1;
        }
    return count;
}

}

TEST(Chains, OnlyContactsAboveTheMeanAreRods)
{
    const Coloured on_the_right = drawn(1, 3, 3);
    EXPECT_EQ(on_the_right.left, 0);
    EXPECT_GT(on_the_right.right, 500);
    const Coloured on_the_left = drawn(3, 1, 3);
    EXPECT_EQ(on_the_left.right, 0);
    EXPECT_NEAR(on_the_left.left, on_the_right.right, 0.3 * on_the_right.right);  // farther away
    const Coloured nowhere = drawn(3, 3, 3);
    EXPECT_EQ(nowhere.left + nowhere.right, 0);
}

TEST(Chains, RodsAreAsThickAsTheirForceIsLarge)
{
    const double thick = drawn(0, 3, 3).right, thin = drawn(0, 3, 6).right;
    EXPECT_LT(thin, 0.65 * thick);
    EXPECT_GT(thin, 0.3 * thick);
    EXPECT_EQ(drawn(0, 9, 3).right, thick);  // held at the end of the colours
}

TEST(Chains, WithoutContactsTheSpheresRemainAndUnknownArraysAreRefused)
{
    render::ParticleView view = test::bare_view(300, 200);
    view.colour_by = "normal_force";
    const Pairs scene = pairs(1, 2);
    const auto none = vtkSmartPointer<vtkPolyData>::New();
    const Image image = render::render_chains(scene.particles, none, view);
    EXPECT_TRUE(std::any_of(image.rgb.begin(), image.rgb.end(), [](int c) { return c < 200; }));
    view.colour_by = "charge";
    EXPECT_THROW(render::render_chains(scene.particles, scene.contacts, view), Error);
}
