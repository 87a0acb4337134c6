// workflows/sweep.h -- what a sweep varies, and the points that come of it.
//
// `--sweep PTR=VALUES` names a place in the workflow by its JSON pointer and values for it: a list
// "0.5,1,2" or a range "from:to:count" (equal steps) or "from:to:count:log" (equal ratios), both
// ends included. A value is JSON, or a bare word that stands for a text. Several parameters: all
// combinations, the last one changes fastest. `repeats` > 1: every combination with so many seeds;
// the first is that of the workflow, the others are made from it.
//
// The name of a point is made of its values alone, so that values can be added to a sweep later:
// "stress_0.5_volume_fraction_0.56", "..._repeat_2" from the second seed on.
#pragma once
#include "io/json_document.h"

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct Swept {
    std::string pointer;  // "/steps/1/stress"
    std::vector<nlohmann::ordered_json> values;
};

struct Sweep {
    std::vector<io::Override> settings;  // the same in all points (--set)
    std::vector<Swept> swept;
    int repeats = 1;
};

struct Point {
    std::string name;
    std::vector<nlohmann::ordered_json> values;  // of the swept parameters, in their order
    int repeat = 1;
    std::vector<io::Override> overrides;  // all that differs from the workflow file
};

inline constexpr std::size_t most_points = 100'000;

/// Of one --sweep. Errors: usage (not of this form, an empty list, a value twice).
Swept parse_swept(const std::string& text);

/// A short name for each of the swept parameters: the last part of the pointer, all of it where
/// that is not enough to tell them apart.
std::vector<std::string> labels(const std::vector<Swept>& swept);

/// As a user would write it: 0.5, heun, [1,2,3].
std::string value_text(const nlohmann::ordered_json& value);

/// All points, before any of them is checked. `seed_of` tells the seed that a point without
/// repeats has; it is asked only if there are repeats. Errors: usage (too many).
std::vector<Point> points_of(const Sweep& sweep,
                             const std::function<std::uint64_t(const Point&)>& seed_of);

/// The workflow as the points read it, whatever happens to its file later: its name and the paths
/// of files in it no longer depend on where it is. Errors: missing, input.
nlohmann::ordered_json frozen_workflow(const std::filesystem::path& file);

/// The same for the values of a sweep and of --set, whose paths count from `folder` as well.
void freeze_paths(nlohmann::ordered_json& value, const std::filesystem::path& folder);
void freeze_paths(io::Override& setting, const std::filesystem::path& folder);

}
