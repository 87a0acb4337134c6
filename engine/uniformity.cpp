#include "engine/uniformity.h"

#include "engine/band_power.h"
#include "engine/error.h"
#include "engine/units.h"

#include <cmath>
#include <string>

namespace sigmaflow {

namespace {

void check(const UniformitySettings& s)
{
    const auto require = [](bool good, const std::string& problem) {
        if (!good) throw Error(ErrorKind::input, "uniformity", problem);
    };
    require(s.level > 0 && s.level <= 0.5,
            "the level must be in (0, 0.5], got " + std::to_string(s.level));
    require(s.power > 0 && s.power < 1,
            "the power must be in (0, 1), got " + std::to_string(s.power));
    require(s.modes >= 3, "at least 3 modes are needed, got " + std::to_string(s.modes));
    require(s.largest_contrast > 0, "the largest contrast must be positive");
    require(s.trials >= 1, "at least one trial is needed");
    require(s.shifts >= 2 / s.level,
            "at least 2/level shifts are needed, got " + std::to_string(s.shifts));
}

std::vector<Mode> modes_of(const Amplitudes& amplitudes, int blocks, const SteadyBands& steady)
{
    std::vector<Mode> modes;
    for (Eigen::Index m = 0; m < amplitudes.rows(); ++m) {
        const std::complex<double> mean = amplitudes.row(m).mean();
        Mode mode;
        mode.wave_number = static_cast<int>(m) + 1;
        mode.amplitude = std::abs(mean);
        const double turns = -std::arg(mean) / (2 * pi) / mode.wave_number;
        mode.phase = turns - std::floor(turns * mode.wave_number) / mode.wave_number;
        mode.fluctuation = (amplitudes.row(m).array() - mean).abs2().mean();
        mode.standard_error = std::sqrt(mode.fluctuation / blocks);
        mode.p_value = steady.mode_p_value[static_cast<std::size_t>(m)];
        modes.push_back(mode);
    }
    return modes;
}

/// Without fluctuations there is nothing to compare.
bool fluctuates(const UniformityTest& test)
{
    for (const Mode& mode : test.modes)
        if (!(mode.fluctuation > 1e-24)) return false;
    return true;
}

/// Means of successive instants.
Field joined(const Field& field, int blocks)
{
    Field result;
    const std::size_t count = static_cast<std::size_t>(blocks);
    for (std::size_t b = 0; b < count; ++b)
        result.push_back(mean_over_instants(
            Field(field.begin() + static_cast<std::ptrdiff_t>(b * field.size() / count),
                  field.begin() + static_cast<std::ptrdiff_t>((b + 1) * field.size() / count))));
    return result;
}

}

std::string_view verdict_name(BandVerdict verdict)
{
    switch (verdict) {
        case BandVerdict::uniform:
            return "uniform";
        case BandVerdict::bands:
            return "bands";
        case BandVerdict::undecided:
            break;
    }
    return "undecided";
}

std::vector<double> mean_over_instants(const Field& field)
{
    std::vector<double> mean(field.at(0).size());
    for (const auto& instant : field)
        for (std::size_t k = 0; k < mean.size(); ++k)
            mean[k] += instant[k] / static_cast<double>(field.size());
    return mean;
}

UniformityTest test_uniformity(const Field& field, const UniformitySettings& settings)
{
    check(settings);
    const Amplitudes amplitudes = mode_amplitudes(field, settings.modes);
    UniformityTest test;
    test.instants = static_cast<int>(field.size());
    test.blocks = test.instants / instants_per_block(amplitudes);
    if (test.blocks < fewest_blocks) return test;

    const BandShapes shapes(settings.modes, static_cast<int>(field[0].size()));
    const Amplitudes blocks = block_means(amplitudes, test.blocks);
    test.steady = search_steady_bands(
        blocks, shapes,
        random_shifts(settings.shifts, test.blocks, shapes.slabs, {settings.seed, 0}));
    test.modes = modes_of(amplitudes, test.blocks, test.steady);
    test.order = order_parameter(joined(field, test.blocks), settings);
    if (!fluctuates(test)) return test;
    const double excess = moving_band_excess(amplitudes);
    const auto expected =
        excess_without_bands(settings.modes, test.blocks - 1, settings.shifts, {settings.seed, 1});
    test.moving = {std::exp(excess), upper_p_value(expected, excess)};
    test.has_steady = test.steady.p_value <= settings.level / 2;
    test.has_moving = test.moving.p_value <= settings.level / 2;
    test.smallest_steady = smallest_steady_contrast(blocks, shapes, settings);
    test.smallest_moving = smallest_moving_contrast(amplitudes, shapes.slabs, expected, settings);
    if (test.smallest_steady) test.at_rest = BandVerdict::uniform;
    if (test.has_steady) test.at_rest = BandVerdict::bands;
    test.verdict = test.has_moving ? BandVerdict::bands : test.at_rest;
    return test;
}

}
