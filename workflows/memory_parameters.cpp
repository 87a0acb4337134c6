#include "workflows/memory_parameters.h"

#include <nlohmann/json.hpp>
#include <numeric>

namespace sigmaflow::workflows {

namespace {

constexpr std::size_t most = 6;  // exponentials

double sum(const std::vector<double>& numbers)
{
    return std::accumulate(numbers.begin(), numbers.end(), 0.);
}

}

void MemoryParameters::describe(io::Fields& f)
{
    f("relaxation_strain", relaxation_strain, io::between(1e-6, 100), "-",
      "1/c: the microstructure follows a step in stress over this strain; default: Mari et al. "
      "2015, phi = 0.58, stress 2 to 3");
    f("relaxation_strain_error", relaxation_strain_error, io::between(0, 100), "-",
      "its standard error");
    f("relaxation_strains", relaxation_strains, io::Length{0, most}, io::between(1e-6, 100), "-",
      "instead: those of a measured memory that is a sum of exponentials");
    f("relaxation_strain_errors", relaxation_strain_errors, io::Length{0, most},
      io::between(0, 100), "-", "their standard errors; default: 0");
    f("weights", weights, io::Length{0, most}, io::between(0, 1e6), "-",
      "of the exponentials, relative to each other; default: equal");
    f("weight_errors", weight_errors, io::Length{0, most}, io::between(0, 1e6), "-",
      "their standard errors; default: 0");
    f("instantaneous_viscosity", instantaneous_viscosity, io::above_to(0, 1e9), "eta0",
      "step in stress over the step in rate that follows at once; default: the viscosity of the "
      "steady state, as in Mari et al. 2015");
    f("response", response, 64,
      "name of a step \"step_stress\" before this one that measured all of that");
}

void MemoryParameters::validate(const io::JsonNode& node, const Plan& plan) const
{
    if (!response.empty()) {
        if (plan.responses.empty())
            throw node.error_at_key("response", "needs a step \"step_stress\" before this one");
        const std::vector<std::string_view> known(plan.responses.begin(), plan.responses.end());
        node.member("response").word(known);
        const bool other_numbers = !relaxation_strains.empty() || !weights.empty() ||
                                   instantaneous_viscosity ||
                                   relaxation_strain != MemoryParameters().relaxation_strain;
        if (other_numbers)
            throw node.error_at_key("response",
                                    "says what the memory is: give no other numbers for it");
    }
    const auto need = [&](const char* name, const std::vector<double>& list) {
        if (!list.empty() && list.size() != relaxation_strains.size())
            throw node.member(name).wrong("must have " + std::to_string(relaxation_strains.size()) +
                                          " numbers, one for each of relaxation_strains");
    };
    need("relaxation_strain_errors", relaxation_strain_errors);
    need("weights", weights);
    need("weight_errors", weight_errors);
    if (!weights.empty() && !(sum(weights) > 0))
        throw node.member("weights").wrong("must have a number > 0");
}

void MemoryParameters::use(Plan& plan, const std::vector<PlannedRun>& runs) const
{
    if (response.empty()) return;  // the state of the suspension stands for the runs
    for (const PlannedRun& run : runs) plan.uses.push_back(run.name);
    plan.uses.push_back(response);
}

std::optional<MemoryParameters> MemoryParameters::measured(const Context& context) const
{
    if (response.empty()) return *this;
    const nlohmann::ordered_json& results = context.finished.at(response);
    if (!results.contains("memory")) return std::nullopt;
    const nlohmann::ordered_json& memory = results["memory"];
    MemoryParameters result;
    result.relaxation_strains = memory["relaxation_strains"].get<std::vector<double>>();
    result.relaxation_strain_errors = memory["relaxation_strain_errors"].get<std::vector<double>>();
    result.weights = memory["weights"].get<std::vector<double>>();
    result.weight_errors = memory["weight_errors"].get<std::vector<double>>();
    result.instantaneous_viscosity = memory["instantaneous_viscosity"].get<double>();
    return result;
}

MemoryKernel MemoryParameters::kernel() const
{
    const auto c = [](double strain, double error) {
        return Value{1 / strain, error / strain / strain};
    };
    if (relaxation_strains.empty())
        return exponential_kernel(c(relaxation_strain, relaxation_strain_error));
    MemoryKernel result;
    const auto at = [](const std::vector<double>& list, std::size_t i, double otherwise) {
        return list.empty() ? otherwise : list[i];
    };
    const std::size_t n = relaxation_strains.size();
    const double total = weights.empty() ? static_cast<double>(n) : sum(weights);
    for (std::size_t i = 0; i < n; ++i)
        result.terms.push_back(
            {.weight = {at(weights, i, 1) / total, at(weight_errors, i, 0) / total},
             .c = c(relaxation_strains[i], at(relaxation_strain_errors, i, 0))});
    return result;
}

MemoryFlow MemoryParameters::flow(Value viscosity, Value slope) const
{
    return {.viscosity = viscosity,
            .slope = slope,
            .kernel = kernel(),
            .instantaneous_viscosity = instantaneous_viscosity};
}

nlohmann::ordered_json MemoryParameters::json() const
{
    auto terms = nlohmann::ordered_json::array();
    for (const MemoryTerm& term : kernel().terms)
        terms.push_back({{"weight", term.weight.mean}, {"relaxation_strain", 1 / term.c.mean}});
    return terms;
}

}
