#include "engine/box.h"

#include "tests/support/random_state.h"

#include <gtest/gtest.h>

namespace sigmaflow {

using support::Random;

TEST(Box, SeparationIsTheShortestOverTheSurroundingImages)
{
    Random random(1);
    for (int trial = 0; trial < 500; ++trial) {
        Box box;
        box.length = Vec3(8, 9, 7) + random.vector();
        box.offset = random.uniform(0, box.length.x());
        const Vec3 p = random.vector().cwiseAbs().cwiseProduct(box.length);
        // within the range in which the nearest image is unique
        const Vec3 q = p + random.uniform(0.1, 3.4) * random.direction();
        double shortest = 1e9;
        for (int y = -2; y <= 2; ++y)
            for (int x = -3; x <= 3; ++x)
                for (int z = -2; z <= 2; ++z)
                    shortest = std::min(shortest, (q - p +
                                                   Vec3(x * box.length.x() + y * box.offset,
                                                        y * box.length.y(), z * box.length.z()))
                                                      .norm());
        EXPECT_NEAR(separation(box, p, q).d.norm(), shortest, 1e-12);
    }
}

TEST(Box, SeparationDoesNotDependOnTheImageOfEitherPoint)
{
    Random random(2);
    Box box{Vec3(8, 9, 7), 3.3};
    for (int trial = 0; trial < 200; ++trial) {
        const Vec3 p = random.vector(20), q = p + random.uniform(0.1, 3.4) * random.direction();
        const Separation original = separation(box, p, q);
        const Vec3 image = q + Vec3(2 * 8 + 3 * box.offset, 3 * 9, -7);
        const Separation moved = separation(box, p, image);
        EXPECT_LT((original.d - moved.d).norm(), 1e-12);
        EXPECT_EQ(moved.image, original.image - 3);
    }
}

TEST(Box, WrappingChangesNoSeparation)
{
    Random random(3);
    Box box{Vec3(8, 9, 7), 8.0 * 2 + 1.7};
    std::vector<Vec3> x, y;
    for (int k = 0; k < 60; ++k) x.push_back(random.vector(40));
    y = x;
    Box wrapped = box;
    wrap(wrapped, y);
    EXPECT_NEAR(wrapped.offset, 1.7, 1e-12);
    for (int i = 0; i < 60; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(y[i][axis], 0);
            EXPECT_LT(y[i][axis], box.length[axis]);
        }
        const Vec3 near = x[i] + 3 * random.direction();
        const Vec3 d = separation(box, x[i], near).d;
        EXPECT_LT((separation(wrapped, y[i], near).d - d).norm(), 1e-11);
    }
}

TEST(Box, ATinyNegativeCoordinateStaysInsideTheCell)
{
    Box box{Vec3(8, 9, 7), 1};
    std::vector<Vec3> x{Vec3(-1e-18, -1e-18, -1e-18)};
    wrap(box, x);
    EXPECT_LT(x[0].x(), 8);
    EXPECT_LT(x[0].y(), 9);
    EXPECT_LT(x[0].z(), 7);
}

}
