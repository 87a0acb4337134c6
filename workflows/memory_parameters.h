// workflows/memory_parameters.h -- the memory of the microstructure as parameters of a step.
#pragma once
#include "engine/memory_kernel.h"
#include "engine/stability.h"
#include "io/json_fields.h"

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

namespace sigmaflow::workflows {

struct MemoryParameters {
    double relaxation_strain = 0.023, relaxation_strain_error = 0;
    std::vector<double> relaxation_strains, relaxation_strain_errors, weights, weight_errors;
    std::optional<double> instantaneous_viscosity;

    void describe(io::Fields& f);
    void validate(const io::JsonNode& node) const;
    /// Weights add to 1.
    MemoryKernel kernel() const;
    MemoryFlow flow(Value viscosity, Value slope) const;
    nlohmann::ordered_json json() const;
};

}
