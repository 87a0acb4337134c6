// io/case_file.h -- configurations with known answers, as JSON (format: tests/data/README.md).
//
// kind "instant":    model, control, state, pair_rows -> all observables of the state
// kind "trajectory": the same start -> shear rate (or stress) at given strains by strain marching
// kind "pairs":      single pairs -> their resistance
// Errors: missing, input (file, line, column and pointer), numerics.
#pragma once
#include "engine/evaluation.h"
#include "engine/model.h"
#include "engine/state.h"
#include "io/json_document.h"

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sigmaflow::io {

struct Case {
    State state;
    Model model;
    Control control;
    std::vector<int> pair_rows;  // rows of the sorted list of pairs in range to show; empty: all
};

/// Reads model, control, state and pair_rows; a touching pair that is not listed under `contacts`
/// has relaxed springs.
Case read_case(const JsonNode& root);

/// Reads {box, offset, positions, radii, contacts}; read_case also does check_state of
/// state_check.h.
State read_state(const JsonNode& node);
nlohmann::ordered_json state_json(const State& state);

/// The entry "expected" of an instantaneous case.
nlohmann::ordered_json observables_json(const Case& one);

/// Strains and step of a trajectory by strain marching.
struct TrajectoryPlan {
    std::vector<double> strain;
    double interval = 0;  // between the strains
    double step = 0;      // divides the interval
};
nlohmann::ordered_json trajectory_json(const Case& one, const TrajectoryPlan& plan);

/// Computes the object {"expected": ...} for the case in a file, as JSON text.
std::string evaluate_case(const std::filesystem::path& path);

/// Reads the case and says in some words what it is: "case, 50 particles, imposed stress 2".
std::string describe_case(const JsonNode& root);

/// Writes a state with its model and control as a case of kind "instant".
void write_case(const std::filesystem::path& path, const State& state, const Model& model,
                const Control& control);

}
