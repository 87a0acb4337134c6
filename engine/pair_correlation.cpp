#include "engine/pair_correlation.h"

#include "engine/error.h"
#include "engine/pair_distances.h"
#include "engine/units.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace sigmaflow {

namespace {

void check(const State& state, const CorrelationGrid& grid)
{
    const auto refuse = [](const std::string& problem) {
        throw Error(ErrorKind::input, "pair_correlation", problem);
    };
    if (state.size() < 2)
        refuse("needs at least two particles, got " + std::to_string(state.size()));
    const double half = largest_pair_distance(state.box);
    if (!(grid.largest_distance > 0) || grid.largest_distance > half * (1 + 1e-12))
        refuse("largest_distance must be above 0 and at most " + std::to_string(half) +
               ", half the smallest box length, got " + std::to_string(grid.largest_distance));
    const double largest = *std::max_element(state.radius.begin(), state.radius.end());
    if (largest * (2 + grid.near_xi) > half)
        refuse("near neighbours must be nearer than " + std::to_string(half) +
               ", half the smallest box length, got " +
               std::to_string(largest * (2 + grid.near_xi)));
    if (grid.bins < 1 || grid.map_bins < 1 || grid.angles < 1) refuse("needs at least one bin");
    if (!(grid.slab > 0) || grid.slab > 1)
        refuse("slab must be in (0, 1], got " + std::to_string(grid.slab));
}

/// Pairs counted in the bins of one frame.
struct Counts {
    std::vector<double> all, map, near;
    std::vector<std::vector<double>> by_species;
    double neighbours = 0, compression = 0, extension = 0;
};

int angle_bin(const Vec3& d, int angles)
{
    double theta = std::atan2(d.y(), d.x());
    if (theta < 0) theta += pi;
    return std::min(static_cast<int>(theta / pi * angles), angles - 1) % angles;
}

void count_near(const Vec3& d, bool in_slab, const CorrelationGrid& grid, Counts& counts)
{
    counts.neighbours += 1;
    counts.compression += d.x() * d.y() < 0;
    counts.extension += d.x() * d.y() > 0;
    if (in_slab) counts.near[angle_bin(d, grid.angles)] += 1;
}

Counts counted(const State& s, const std::vector<int>& kind, bool two_species,
               const CorrelationGrid& grid)
{
    Counts counts;
    counts.all.assign(grid.bins, 0);
    counts.map.assign(static_cast<std::size_t>(grid.map_bins) * grid.angles, 0);
    counts.near.assign(grid.angles, 0);
    if (two_species) counts.by_species.assign(3, counts.all);
    const double largest = *std::max_element(s.radius.begin(), s.radius.end());
    const double near_factor = 1 + grid.near_xi / 2;
    const double reach = std::max(grid.largest_distance, 2 * largest * near_factor);
    PairDistances(s).each(reach, [&](int i, int j, const Vec3& d, double r) {
        const bool in_slab = std::abs(d.z()) < grid.slab * r;
        if (r < (s.radius[i] + s.radius[j]) * near_factor) count_near(d, in_slab, grid, counts);
        const double share = r / grid.largest_distance;
        if (!(share < 1)) return;
        const int bin = std::min(static_cast<int>(share * grid.bins), grid.bins - 1);
        counts.all[bin] += 1;
        if (two_species) counts.by_species[kind[i] + kind[j]][bin] += 1;
        if (!in_slab) return;
        const int ring = std::min(static_cast<int>(share * grid.map_bins), grid.map_bins - 1);
        counts.map[static_cast<std::size_t>(ring) * grid.angles + angle_bin(d, grid.angles)] += 1;
    });
    return counts;
}

/// (r_2^3 - r_1^3)/3 of a bin.
double cubic_share(double largest, int bins, int bin)
{
    const double width = largest / bins;
    return (std::pow((bin + 1) * width, 3) - std::pow(bin * width, 3)) / 3;
}

/// Counts over those of an ideal gas of `pairs` pairs; 0 for no pairs.
std::vector<double> over_ideal_gas(std::vector<double> counts, double pairs, double volume,
                                   const CorrelationGrid& grid)
{
    for (int k = 0; k < grid.bins; ++k) {
        const double shell = 4 * pi * cubic_share(grid.largest_distance, grid.bins, k);
        counts[k] = pairs > 0 ? counts[k] * volume / (pairs * shell) : 0;
    }
    return counts;
}

std::vector<Estimate> estimates(
    std::span<const PairCorrelation> frames,
    const std::function<const std::vector<double>&(const PairCorrelation&)>& values)
{
    std::vector<std::vector<double>> series;
    for (const PairCorrelation& frame : frames) {
        const std::vector<double>& one = values(frame);
        series.resize(std::max(series.size(), one.size()));
        for (std::size_t k = 0; k < one.size(); ++k) series[k].push_back(one[k]);
    }
    std::vector<Estimate> result;
    for (const auto& one : series) result.push_back(estimate_mean(one));
    return result;
}

Estimate estimate(std::span<const PairCorrelation> frames, double PairCorrelation::*value)
{
    std::vector<double> series;
    for (const PairCorrelation& frame : frames) series.push_back(frame.*value);
    return estimate_mean(series);
}

}

double CorrelationGrid::angle(int bin) const
{
    return (bin + 0.5) * 180 / angles;
}

double largest_pair_distance(const Box& box)
{
    return box.length.minCoeff() / 2;
}

PairCorrelation pair_correlation(const State& state, const CorrelationGrid& grid)
{
    check(state, grid);
    const std::vector<int> kind = species(state);
    const bool two_species = *std::max_element(kind.begin(), kind.end()) == 1;
    Counts counts = counted(state, kind, two_species, grid);

    PairCorrelation result;
    const double n = state.size(), volume = state.box.volume(), pairs = n * (n - 1) / 2;
    result.all = over_ideal_gas(std::move(counts.all), pairs, volume, grid);
    if (two_species) {
        const auto large = static_cast<double>(std::count(kind.begin(), kind.end(), 1));
        const double small = n - large;
        const double of_species[] = {small * (small - 1) / 2, small * large,
                                     large * (large - 1) / 2};
        for (int k = 0; k < 3; ++k)
            result.by_species.push_back(
                over_ideal_gas(std::move(counts.by_species[k]), of_species[k], volume, grid));
    }
    result.map = std::move(counts.map);
    for (std::size_t k = 0; k < result.map.size(); ++k) {
        const double sector =
            cubic_share(grid.largest_distance, grid.map_bins, static_cast<int>(k) / grid.angles) *
            2 * grid.slab * 2 * pi / grid.angles;
        result.map[k] *= volume / (pairs * sector);
    }
    double in_slab = 0;
    for (const double count : counts.near) in_slab += count;
    if (in_slab > 0)
        for (const double count : counts.near) result.near.push_back(count * grid.angles / in_slab);
    result.near_neighbours = 2 * counts.neighbours / n;
    const double in_quadrants = counts.compression + counts.extension;
    if (in_quadrants > 0)
        result.quadrant_anisotropy = (counts.compression - counts.extension) / in_quadrants;
    return result;
}

MeanPairCorrelation mean_pair_correlation(std::span<const PairCorrelation> frames)
{
    MeanPairCorrelation mean;
    if (frames.empty()) return mean;
    using Frame = PairCorrelation;
    mean.all = estimates(
        frames, [](const Frame& f) -> const auto& { return f.all; });
    mean.map = estimates(
        frames, [](const Frame& f) -> const auto& { return f.map; });
    mean.near = estimates(
        frames, [](const Frame& f) -> const auto& { return f.near; });
    for (std::size_t k = 0; k < frames.front().by_species.size(); ++k)
        mean.by_species.push_back(estimates(
            frames, [k](const Frame& f) -> const auto& { return f.by_species[k]; }));
    mean.near_neighbours = estimate(frames, &Frame::near_neighbours);
    mean.quadrant_anisotropy = estimate(frames, &Frame::quadrant_anisotropy);
    return mean;
}

Peak highest_peak(std::span<const Estimate> g, const CorrelationGrid& grid)
{
    const auto highest = std::max_element(
        g.begin(), g.end(), [](const Estimate& a, const Estimate& b) { return a.mean < b.mean; });
    if (highest == g.end()) return {};
    return {grid.distance(static_cast<int>(highest - g.begin())), *highest};
}

}
