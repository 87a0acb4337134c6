// workflows/memory_parameters.h -- the memory of the microstructure as parameters of a step.
#pragma once
#include "engine/memory_kernel.h"
#include "engine/stability.h"
#include "workflows/step.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace sigmaflow::workflows {

struct MemoryParameters {
    double relaxation_strain = 0.023, relaxation_strain_error = 0;
    std::vector<double> relaxation_strains, relaxation_strain_errors, weights, weight_errors;
    std::optional<double> instantaneous_viscosity;
    std::string response;  // a step "step_stress" that measured all that

    void describe(io::Fields& f);
    void validate(const io::JsonNode& node, const Plan& plan) const;
    /// The step depends on these runs, and on the response.
    void use(Plan& plan, const std::vector<PlannedRun>& runs) const;
    /// Without `response`: its numbers. Nothing if that step did not resolve a memory.
    std::optional<MemoryParameters> measured(const Context& context) const;
    /// Weights add to 1.
    MemoryKernel kernel() const;
    MemoryFlow flow(Value viscosity, Value slope) const;
    nlohmann::ordered_json json() const;
};

/// Calls `work` on the step with the memory that it names; says why if that was not resolved.
template <class Step>
void run_with_memory(const Step& step, Context& context, void (Step::*work)(Context&) const)
{
    Step resolved = step;
    const auto measured = step.memory.measured(context);
    if (!measured) {
        context.results["outcome"] = "nothing to say, " + step.memory.response +
                                     " did not resolve how the suspension remembers";
        return;
    }
    resolved.memory = *measured;
    (resolved.*work)(context);
}

}
