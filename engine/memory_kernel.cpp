#include "engine/memory_kernel.h"

#include "engine/error.h"

#include <cmath>
#include <string>

namespace sigmaflow {

namespace {

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "memory kernel", problem);
}

/// w_i = amplitude_i times the factor; what is missing to 1 follows at once.
MemoryKernel scaled(const Relaxation& response, double factor)
{
    MemoryKernel kernel{.terms = {}, .instantaneous = 1};
    for (const RelaxationTerm& term : response.terms) {
        const double strain = term.relaxation_strain.mean;
        kernel.terms.push_back(
            {.weight = {factor * term.amplitude.mean,
                        std::abs(factor) * term.amplitude.standard_error},
             .c = {1 / strain, term.relaxation_strain.standard_error / strain / strain}});
        kernel.instantaneous -= kernel.terms.back().weight.mean;
    }
    check(kernel);
    return kernel;
}

}

double Relaxation::at(double strain) const
{
    double value = plateau.mean;
    for (const RelaxationTerm& term : terms)
        value += term.amplitude.mean * std::exp(-strain / term.relaxation_strain.mean);
    return value;
}

const Relaxation& better_of(const Relaxation& one, const Relaxation& two)
{
    return two.resolved && two.aic < one.aic ? two : one;
}

MemoryKernel exponential_kernel(Value c)
{
    MemoryKernel kernel{.terms = {{.weight = {1, 0}, .c = c}}};
    check(kernel);
    return kernel;
}

void check(const MemoryKernel& kernel)
{
    require(!kernel.terms.empty(), "needs at least one exponential");
    double sum = kernel.instantaneous, size = std::abs(sum);
    for (const MemoryTerm& term : kernel.terms) {
        require(term.c.mean > 0 && std::isfinite(term.c.mean),
                "relaxation must be > 0, got " + std::to_string(term.c.mean));
        sum += term.weight.mean;
        size += std::abs(term.weight.mean);
    }
    require(std::isfinite(sum) && std::abs(sum - 1) <= 1e-9 * size,
            "weights must add to 1, got " + std::to_string(sum));
}

double density(const MemoryKernel& kernel, double strain)
{
    double result = 0;
    for (const MemoryTerm& term : kernel.terms)
        result += term.weight.mean * term.c.mean * std::exp(-term.c.mean * strain);
    return result;
}

MemoryKernel kernel_of(const Relaxation& response, double before)
{
    const double change = response.plateau.mean - before;
    require(change != 0 && std::isfinite(change), "the plateau must differ from the value before");
    return scaled(response, -1 / change);
}

MemoryKernel kernel_of_rate(const Relaxation& rate_response, double before, double stress,
                            double step)
{
    require(before > 0 && step != 0, "needs a rate > 0 before a step in stress");
    const double viscosity = stress / before;
    const double g = 1 - viscosity * (rate_response.plateau.mean - before) / step;
    require(g != 0 && std::isfinite(g), "the viscosity must change with the stress");
    return scaled(rate_response, viscosity / (g * step));
}

}
