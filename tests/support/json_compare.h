// tests/support/json_compare.h -- largest deviation of computed from stored numbers.
//
// Relative to the largest entry of each array; `stress`, `power` and `force_on_i`, whose parts
// share a unit, relative to the largest of all parts.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sigmaflow::support {

struct Deviation {
    double value = 0;
    std::string where;
};

/// Keys that the stored object lacks are not compared; keys that the computed one lacks are an
/// error.
Deviation deviation(const nlohmann::json& stored, const nlohmann::json& computed);

}
