// workflows/step_names.h -- the steps of a workflow file one by one: sweeps unfolded, all named.
#pragma once
#include "io/problems.h"
#include "workflows/step.h"

#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

inline constexpr std::size_t most_steps = 1000, longest_name = 64;

/// 1 to 64 letters, digits, _ or -, not beginning with -, points only in numbers: no name is that
/// of a file.
bool is_name(const std::string& text);
inline constexpr const char* name_pattern = "^(?!-)(?:[A-Za-z0-9_-]|(?<=[0-9])\\.(?=[0-9])){1,64}$";
inline constexpr const char* name_rule =
    "must be 1 to 64 letters, digits, _ or -, not beginning with -";

/// What a step of the file says, or one of the steps that it stands for with a "sweep".
struct StepText {
    io::JsonNode node;
    std::string swept = {};                  // name of the parameter
    std::optional<io::JsonNode> value = {};  // of it
};

/// Errors: input (a sweep of no, or of more than one parameter).
std::vector<StepText> unfolded(const io::JsonNode& node);

/// Steps are named after their kind, the second one of a kind "<kind>_2" and so on, unless named;
/// those of a sweep after the value, too: "<name>_0.5".
void name_steps(std::vector<Step>& steps, const std::vector<StepText>& texts,
                io::Problems& problems);

}
