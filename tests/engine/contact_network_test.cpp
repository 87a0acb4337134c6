#include "engine/contact_network.h"

#include "engine/clusters.h"
#include "engine/error.h"
#include "engine/evaluation.h"
#include "engine/pairs.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numeric>

namespace sigmaflow {

namespace {

/// Particles at points, without contacts yet.
Frame frame_of(const Vec3& length, double offset, const std::vector<Vec3>& points)
{
    Frame f;
    f.state.box = {length, offset};
    f.state.position = points;
    f.state.radius.assign(points.size(), 0.5);
    f.contact_number.assign(points.size(), 0);
    return f;
}

void connect(Frame& f, int i, int j, bool frictional = true, bool sliding = false)
{
    const Vec3 d = separation(f.state.box, f.state.position[i], f.state.position[j]).d;
    ++f.contact_number[i];
    ++f.contact_number[j];
    f.contacts.push_back({std::min(i, j), std::max(i, j), f.state.position[std::min(i, j)],
                          f.state.position[std::min(i, j)] + (i < j ? d : Vec3(-d)), -0.01, 1,
                          Vec3(0, 0, 0.5), sliding, frictional});
}

/// A closed row of n particles that goes on by `span` after its last one.
Frame row(const Vec3& length, double offset, const Vec3& span, int n)
{
    std::vector<Vec3> points;
    for (int k = 0; k < n; ++k) points.emplace_back(k * span / n);
    Frame f = frame_of(length, offset, points);
    wrap(f.state.box, f.state.position);
    for (int k = 0; k < n; ++k) connect(f, k, (k + 1) % n);
    return f;
}

Cluster only_cluster(const Frame& f)
{
    const auto all = clusters(f);
    EXPECT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].size, f.state.size());
    return all[0];
}

void expect_percolates(const Frame& f, bool flow, bool gradient, bool vorticity)
{
    const Cluster c = only_cluster(f);
    EXPECT_EQ(c.flow, flow);
    EXPECT_EQ(c.gradient, gradient);
    EXPECT_EQ(c.vorticity, vorticity);
}

/// Touching pairs of a dense random state, some of them sliding or frictionless.
Frame random_frame(unsigned seed, double phi = 0.55, double offset = 0.3)
{
    State s = support::dense_state(60, phi, offset, seed);
    for (double& r : s.radius) r *= 1.03;
    Frame f;
    f.state = s;
    f.contact_number.assign(s.radius.size(), 0);
    support::Random random(seed);
    NeighbourList list;
    list.update(s, 0);
    for (const Pair& p : find_pairs(s, 0, list)) {
        ++f.contact_number[p.i];
        ++f.contact_number[p.j];
        const bool frictional = random.uniform(0, 1) < 0.8;
        f.contacts.push_back({p.i, p.j, s.position[p.i], s.position[p.i] + p.separation, p.xi,
                              random.uniform(0, 3), random.vector(),
                              frictional && random.uniform(0, 1) < 0.3, frictional});
    }
    return f;
}

constexpr double L = 6;
const Vec3 cube(L, L, L);

}

TEST(Clusters, RowsPercolateAlongTheirOwnDirectionOnly)
{
    expect_percolates(row(cube, 1.7, Vec3(L, 0, 0), 6), true, false, false);
    expect_percolates(row(cube, 1.7, Vec3(1.7, L, 0), 6), false, true, false);
    expect_percolates(row(cube, 1.7, Vec3(0, 0, L), 6), false, false, true);
    // beside the first image above
    expect_percolates(row(cube, 1.7, Vec3(1.7 - L, L, 0), 9), false, true, false);
    // a helix winds once around the gradient and twice around the vorticity
    expect_percolates(row(cube, 0.9, Vec3(0.9, L, 2 * L), 20), false, true, true);
}

TEST(Clusters, UprightColumnInAShearedBoxDoesNotPercolateAlongTheFlow)
{
    // it meets itself after three boxes upwards, one image to the side
    expect_percolates(row(cube, L / 3, Vec3(0, 3 * L, 0), 18), false, true, false);
}

TEST(Clusters, RingsInsideTheBoxDoNotPercolate)
{
    std::vector<Vec3> points;
    for (int k = 0; k < 12; ++k)
        points.emplace_back(5.5 + 1.9 * std::cos(k * pi / 6), 5.9 + 1.9 * std::sin(k * pi / 6), 0);
    Frame f = frame_of(cube, 2.2, points);  // across all boundaries
    wrap(f.state.box, f.state.position);
    for (int k = 0; k < 12; ++k) connect(f, k, (k + 1) % 12);
    expect_percolates(f, false, false, false);
    // nor if their particles are stored as images far up and down
    for (int k = 0; k < 12; ++k) {
        const int up = k % 5 - 2, along = k % 3;
        f.state.position[k] += Vec3(up * 2.2 + along * L, up * L, k % 2 * L);
    }
    expect_percolates(f, false, false, false);
}

TEST(Clusters, TwoRowsThatTouchPercolateAlongBoth)
{
    Frame f = row(cube, 1.7, Vec3(L, 0, 0), 6);
    const int first = f.state.size();
    for (int k = 1; k < 6; ++k) f.state.position.emplace_back(1.7 * k / 6, k, 0);
    f.state.radius.assign(f.state.position.size(), 0.5);
    f.contact_number.assign(f.state.position.size(), 0);
    for (int k = 0; k < 4; ++k) connect(f, first + k, first + k + 1);
    connect(f, 0, first);
    EXPECT_EQ(only_cluster(f).gradient, false);
    connect(f, 0, first + 4);
    expect_percolates(f, true, true, false);
}

TEST(Clusters, DoNotDependOnImagesOffsetPeriodOrLabels)
{
    for (unsigned seed = 1; seed < 9; ++seed) {
        const Frame f = random_frame(seed, seed % 2 ? 0.4 : 0.5);
        auto summary = [](const Frame& frame) {
            std::vector<std::array<int, 4>> list;
            for (const Cluster& c : clusters(frame))
                list.push_back({c.size, c.flow, c.gradient, c.vorticity});
            std::sort(list.begin(), list.end());
            return list;
        };
        const auto expected = summary(f);
        Frame other = f;
        other.state.box.offset += other.state.box.length.x();
        EXPECT_EQ(summary(other), expected);
        other = f;
        support::Random random(seed);
        const Box& box = f.state.box;
        for (Vec3& p : other.state.position) {
            const double up = std::floor(random.uniform(-2, 3));
            p += Vec3(up * box.offset + std::floor(random.uniform(-2, 3)) * box.length.x(),
                      up * box.length.y(), std::floor(random.uniform(-2, 3)) * box.length.z());
        }
        EXPECT_EQ(summary(other), expected);
        other = f;
        const int n = f.state.size();
        for (int i = 0; i < n; ++i) other.state.position[n - 1 - i] = f.state.position[i];
        for (ContactForce& c : other.contacts) {
            c.i = n - 1 - c.i;
            c.j = n - 1 - c.j;
        }
        EXPECT_EQ(summary(other), expected);
    }
}

TEST(ContactNetwork, TreesAreRattlersAndTheTailOfARingToo)
{
    Frame f = row(cube, 0, Vec3(L, 0, 0), 6);
    for (int k = 1; k < 5; ++k) f.state.position.emplace_back(3, k, 0);
    f.state.radius.assign(10, 0.5);
    f.contact_number.assign(10, 0);
    connect(f, 3, 6);
    for (int k = 6; k < 9; ++k) connect(f, k, k + 1);
    const std::vector<bool> loose = rattlers(f, 2);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(loose[i], i >= 6) << i;
    const ContactNetwork net = contact_network(f, {.least_contacts = 2, .close_gap = 0});
    EXPECT_DOUBLE_EQ(net.rattler_fraction, 0.4);
    EXPECT_DOUBLE_EQ(net.contact_number, 2);
    EXPECT_DOUBLE_EQ(net.net_contact_number, 2);
    EXPECT_DOUBLE_EQ(net.net_constraint_number, 3);
    EXPECT_DOUBLE_EQ(net.largest_cluster_fraction, 1);
    EXPECT_EQ(net.percolates_flow, 1);
    EXPECT_EQ(net.percolates_gradient, 0);
    EXPECT_DOUBLE_EQ(contact_network(f, {.least_contacts = 3}).rattler_fraction, 1);
    EXPECT_EQ(contact_network(f, {.least_contacts = 3}).net_contact_number, 0);
}

TEST(ContactNetwork, AgreesWithASlowTwin)
{
    for (unsigned seed = 1; seed < 6; ++seed) {
        const Frame f = random_frame(seed);
        const int n = f.state.size();
        for (const int least : {2, 4}) {
            // passes over all particles until nothing changes
            std::vector<bool> gone(n, false);
            for (bool changed = true; changed;) {
                changed = false;
                for (int i = 0; i < n; ++i) {
                    int left = 0;
                    for (const ContactForce& c : f.contacts)
                        left += (c.i == i && !gone[c.j]) || (c.j == i && !gone[c.i]);
                    if (!gone[i] && left < least) changed = gone[i] = true;
                }
            }
            EXPECT_EQ(rattlers(f, least), gone);
        }
        const double gap = 0.2;
        int close = 0, sticking = 0, frictional = 0;
        for (int i = 0; i < n; ++i)
            for (int j = i + 1; j < n; ++j)
                close +=
                    separation(f.state.box, f.state.position[i], f.state.position[j]).d.norm() <
                    f.state.radius[i] + f.state.radius[j] + gap;
        for (const ContactForce& c : f.contacts) {
            frictional += c.frictional;
            sticking += c.frictional && !c.sliding;
        }
        const ContactNetwork net = contact_network(f, {.close_gap = gap});
        EXPECT_DOUBLE_EQ(net.frictional_pair_fraction, double(frictional) / close);
        EXPECT_DOUBLE_EQ(net.constraint_number * n, 2. * sticking + double(f.contacts.size()));
        EXPECT_DOUBLE_EQ(net.sliding_fraction * frictional, frictional - sticking);
        // the mean of the distribution is the contact number
        double mean = 0, all = 0;
        const ContactShares shares = contact_shares(std::span(&f, 1));
        for (std::size_t z = 0; z < shares.share.size(); ++z) {
            mean += static_cast<double>(z) * shares.share[z].mean;
            all += shares.share[z].mean;
        }
        EXPECT_NEAR(mean, net.contact_number, 1e-12);
        EXPECT_NEAR(all, 1, 1e-12);
    }
}

TEST(ContactNetwork, AgreesWithTheSampleOfAnEvaluatedState)
{
    State s = support::dense_state(40, 0.55, 0.4, 3);
    for (double& r : s.radius) r *= 1.02;
    Workspace workspace;
    const DetailedEvaluation d = evaluate_in_detail(s, {}, ImposedStress{2}, workspace);
    const Frame f = make_frame(s, d);
    ASSERT_GT(f.contacts.size(), 20u);
    const ContactNetwork net = contact_network(f, {});
    EXPECT_DOUBLE_EQ(net.contact_number, f.sample.contact_number);
    EXPECT_DOUBLE_EQ(net.frictional_contact_number, f.sample.frictional_contact_number);
    EXPECT_DOUBLE_EQ(net.sliding_fraction, f.sample.sliding_fraction);
    EXPECT_EQ(net.frictional_contact_fraction, 1);
}

TEST(ContactNetwork, WithoutContactsEverythingIsZeroButRattlers)
{
    const ContactNetwork net = contact_network(frame_of(cube, 0, {{1, 1, 1}, {4, 4, 4}}), {});
    for (const NetworkField& field : network_fields()) {
        const double expected = field.name == "rattler_fraction"           ? 1
                                : field.name == "largest_cluster_fraction" ? 0.5
                                                                           : 0;
        EXPECT_EQ(net.*field.value, expected) << field.name;
    }
    EXPECT_THROW(contact_network({}, {.least_contacts = 0}), Error);
    EXPECT_THROW(contact_network({}, {.close_gap = -1}), Error);
}

TEST(Fabric, ContactsAlongTheCompressionAxisAreAt135Degrees)
{
    const std::vector<Frame> frames{row(cube, 0, Vec3(-L, L, 0), 10)};
    const auto fabric = fabric_tensors(frames, ContactSet::all);
    ASSERT_EQ(fabric.size(), 1u);
    EXPECT_NEAR(fabric[0](0, 0), 0.5, 1e-12);
    EXPECT_NEAR(fabric[0](0, 1), -0.5, 1e-12);
    EXPECT_NEAR(fabric[0].trace(), 1, 1e-12);
    const PlaneAnisotropy a = plane_anisotropy(fabric);
    EXPECT_NEAR(a.anisotropy.mean, 1, 1e-12);
    EXPECT_NEAR(a.angle.mean, 135, 1e-9);
    EXPECT_EQ(fabric_tensors(frames, ContactSet::sliding).size(), 0u);
}

TEST(Fabric, OfALatticeIsIsotropicAndSplitsIntoItsParts)
{
    std::vector<Vec3> points;
    for (int k = 0; k < 27; ++k) points.emplace_back(2 * (k % 3), 2 * (k / 3 % 3), 2 * (k / 9));
    Frame f = frame_of(cube, 0, points);
    for (int k = 0; k < 27; ++k) {
        const int x = k % 3, y = k / 3 % 3, z = k / 9;
        connect(f, k, (x + 1) % 3 + 3 * y + 9 * z, false);
        connect(f, k, x + 3 * ((y + 1) % 3) + 9 * z, true);
        connect(f, k, x + 3 * y + 9 * ((z + 1) % 3), true, true);
    }
    const std::vector<Frame> frames{f};
    EXPECT_NEAR((fabric_tensors(frames, ContactSet::all)[0] - Mat3::Identity() / 3).norm(), 0,
                1e-12);
    EXPECT_NEAR(fabric_tensors(frames, ContactSet::frictional)[0](1, 1), 0.5, 1e-12);
    EXPECT_NEAR(fabric_tensors(frames, ContactSet::sliding)[0](2, 2), 1, 1e-12);
    EXPECT_NEAR(plane_anisotropy(fabric_tensors(frames, ContactSet::all)).anisotropy.mean, 0,
                1e-12);
}

TEST(Fabric, ErrorsOfAnisotropyAndAngleAreThoseOfTheirScatter)
{
    // F_xx - F_yy = s + 2 noise, 2 F_xy = -0.2 + 2 noise
    std::mt19937 generator(3);
    std::normal_distribution<double> noise(0, 0.02);
    std::vector<Mat3> tensors;
    for (int k = 0; k < 1000; ++k) {
        Mat3 f = Mat3::Identity() / 3;
        f(0, 1) = f(1, 0) = -0.1 + noise(generator);
        const double d = noise(generator);
        f(0, 0) += d;
        f(1, 1) -= d;
        tensors.push_back(f);
    }
    const PlaneAnisotropy a = plane_anisotropy(tensors);
    const double error = 0.04 / std::sqrt(1000);
    EXPECT_NEAR(a.anisotropy.standard_error, error, 0.4 * error);
    EXPECT_NEAR(a.anisotropy.mean, 0.2, 4 * error);
    const double angle_error = error / 0.2 / 2 * 180 / pi;
    EXPECT_NEAR(a.angle.standard_error, angle_error, 0.4 * angle_error);
    EXPECT_NEAR(a.angle.mean, 135, 4 * angle_error);
}

TEST(ContactForces, AreMeasuredInTheirMean)
{
    const std::vector<Frame> frames{random_frame(1), random_frame(2)};
    for (const RelativeForces& forces : {normal_forces(frames), tangential_forces(frames)}) {
        double sum = 0, count = 0;
        for (const auto& frame : forces.frames)
            for (double x : frame) {
                sum += x;
                count += 1;
                EXPECT_LE(x, forces.largest);
            }
        EXPECT_NEAR(sum / count, 1, 1e-12);
    }
    EXPECT_NEAR(normal_forces(frames).mean, 1.5, 0.2);  // uniform from 0 to 3
    EXPECT_TRUE(normal_forces({}).frames.empty());
}

}
