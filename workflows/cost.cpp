#include "workflows/cost.h"

#include "engine/packing.h"
#include "engine/step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

namespace {

constexpr double friction_off_fraction = 0.685, friction_on_fraction = 0.596, onset = 1.25;
constexpr double nearest_to_jamming = 0.01;

struct Flow {
    double particles = 0, volume_fraction = 0;
    bool from_packing = true;
    double jamming_fraction = 0;

    double distance() const { return jamming_fraction - volume_fraction; }
};

/// What is known while the steps are gone through.
struct Course {
    const Json& suspension;
    double volume_fraction = 0;
    bool from_packing = true;
    int threads = 1;
};

double jamming_fraction(double stress, const Json& model)
{
    const bool friction = model.value("friction_static", 1.) > 0;
    const bool repulsion = model.value("repulsion", 1.) > 0;
    const double share = !friction ? 0 : repulsion ? std::exp(-onset / stress) : 1;
    return friction_on_fraction * share + friction_off_fraction * (1 - share);
}

/// The stress of an imposed rate, by bisection.
double stress_at(double rate, double volume_fraction, const Json& model)
{
    double low = 1e-6, high = 1e9;
    for (int k = 0; k < 60; ++k) {
        const double stress = std::sqrt(low * high);
        const double left = 1 - volume_fraction / jamming_fraction(stress, model);
        const double found = left > 0 ? stress * left * left : 0;
        (found > rate || left <= 0 ? high : low) = stress;
    }
    return low;
}

double steps_per_strain(const Flow& flow, double strain)
{
    constexpr double contacts_after = 0.15;
    const double x = strain / contacts_after;
    const double touching = flow.from_packing ? 1 - (1 - std::exp(-x)) / x : 1;
    const double distance = std::max(flow.distance(), nearest_to_jamming);
    return std::pow(flow.particles / 500, 0.134) *
           (156 + 11.8 * touching * std::pow(distance, -1.59));
}

double direct_solution(double n, double phi)
{
    return 22e-6 * n + 92e-3 * std::pow(n / 1000, 1.65) * std::pow(phi / 0.5, 2.63);
}

double packing_seconds(double n, double phi)
{
    return 1e-6 * n * (10 + 40 * std::exp(15.7 * (phi - 0.5)));
}

double step_seconds(double n, double phi, const std::string& scheme, const std::string& solver)
{
    const double particle = scheme == "implicit" ? 2.5e-6 : scheme == "heun" ? 2.0e-6 : 1.25e-6;
    const double step = particle * n * (1 + 0.6 * n * n / (n * n + 1500. * 1500.));
    if (solver == "cholesky") return step + 0.6 * direct_solution(n, phi);
    if (solver == "lagged_cholesky") return 5.4 * step;
    return step;
}

double samples_seconds(double samples, double step)
{
    return samples * 1.4 * step;
}

Json model_of(const Json& step, const Course& course)
{
    Json model = course.suspension.value("model", Json::object());
    if (step.contains("model") && step["model"].is_object()) model.update(step["model"]);
    return model;
}

double number(const Json& step, const char* key, double otherwise)
{
    return step.contains(key) && step[key].is_number() ? step[key].get<double>() : otherwise;
}

Flow flow_of(const Json& step, const Needs& needs, const Course& course, double stress)
{
    const double phi = number(step, "volume_fraction", course.volume_fraction);
    return {needs.particles, phi, course.from_packing,
            jamming_fraction(stress, model_of(step, course))};
}

/// Of `strain` at a stress, with the parameters of the step.
double shearing_seconds(const Json& step, const Flow& flow, double strain)
{
    const std::string scheme = step.value("scheme", "implicit");
    const std::string solver = step.value("solver", "pcg");
    const bool long_steps = scheme == "implicit";
    const double usual = long_steps ? 1e-2 : 1e-3;
    const double steps = steps_per_strain(flow, strain) * strain * (long_steps ? 1 : 9.5) *
                         std::pow(number(step, "displacement", usual) / usual, -0.98);
    const double one = step_seconds(flow.particles, flow.volume_fraction, scheme, solver);
    return steps * one + samples_seconds(strain / number(step, "series_interval", strain), one);
}

StepCost shear_cost(const Json& step, const Needs& needs, const Course& course)
{
    const Json model = model_of(step, course);
    const double stress = step.contains("rate") && step["rate"].is_number()
                              ? stress_at(step["rate"], course.volume_fraction, model)
                              : number(step, "stress", 1);
    const Flow flow = flow_of(step, needs, course, stress);
    const double longest = number(step, "strain", number(step, "maximum_strain", 1));
    const double expected = std::min(longest, 1.5 * number(step, "minimum_strain", longest));
    const double frames = needs.frames * direct_solution(flow.particles, flow.volume_fraction);
    return {.name = "",
            .seconds = shearing_seconds(step, flow, expected) + frames,
            .at_most = shearing_seconds(step, flow, longest) + frames,
            .jams = flow.distance() < 0 && step.contains("stress") && step["stress"].is_number()};
}

/// Steps that make many runs of their own.
StepCost ensemble_cost(const Json& step, const Needs& needs, const Course& course)
{
    const double lowest = number(step, "lowest_stress", 1);
    const double highest = number(step, "highest_stress", lowest);
    const double stress = number(step, "stress_before", std::sqrt(lowest * highest));
    const Flow flow = flow_of(step, needs, course, stress);
    const double packing = packing_seconds(flow.particles, flow.volume_fraction);
    const double starts = number(step, "starts", 1);
    const auto runs = [&](double count, double strain) {
        return count * (shearing_seconds(step, flow, strain) + packing) / course.threads;
    };
    if (step["step"] == "step_stress") {
        const double all = runs(starts, number(step, "strain_before", 2)) +
                           runs(starts, number(step, "strain_after", 0.2));
        return {"", all, all, false};
    }
    if (step["step"] == "jamming") {
        const double fractions =
            step.contains("volume_fractions") && !step["volume_fractions"].empty()
                ? static_cast<double>(step["volume_fractions"].size())
                : 1;
        const double halvings =
            2 + std::log2(std::log(highest / lowest) / std::log(number(step, "ratio", 1.1)));
        const double strain = number(step, "strain_before", 1) + number(step, "strain", 2);
        const double all = runs(fractions * starts * halvings, strain);
        return {"", 0.5 * all, all, true};  // half of them jam early
    }
    const double longest =
        runs(number(step, "most_points", 30), number(step, "maximum_strain", 30));
    return {"",
            std::min(longest, runs(2 * number(step, "points", 6), 2 * number(step, "strain", 3))),
            longest, false};
}

/// Pictures and analyses: of the frames that are read, of their pixels, and of what they compute.
StepCost other_cost(const Json& step, const Needs& needs, const Course& course)
{
    const std::string kind = step["step"];
    const double values = needs.frames_read * needs.particles;
    double seconds = 0.02 + 3e-6 * values + 0.3 * (needs.drawn_pixels > 0) +
                     1.0e-6 * needs.drawn_pixels + 0.12e-6 * needs.plotted_pixels;
    if (kind == "structure" || kind == "nonaffine") seconds += 0.3 + 5e-6 * values;
    if (kind == "uniformity") seconds += 0.4 + 5e-6 * values;
    if (kind == "energy")
        seconds +=
            1.4 * needs.frames_read * direct_solution(needs.particles, course.volume_fraction);
    if (kind == "wyart_cates" || kind == "stability" || kind == "one_dimensional_flow")
        seconds += 5;
    return {"", seconds, seconds, false};
}

double cpu_seconds()
{
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}

double machine_factor(const Suspension& suspension)
{
    constexpr int largest = 1000, block = 20;
    // steps soon after the start, with few contacts yet, take less than those that follow
    constexpr double reference = 0.54;
    PackingParameters parameters = suspension.packing;
    parameters.particles = std::min(parameters.particles, largest);
    if (!parameters.radii.empty()) {
        parameters.radii.resize(std::min<std::size_t>(parameters.radii.size(), largest));
        parameters.particles = static_cast<int>(parameters.radii.size());
    }
    parameters.volume_fraction = std::min(parameters.volume_fraction, 0.58);
    const Model model;
    State state;
    try {
        state = random_packing(parameters);
    } catch (const Error&) {  // a part of the radii may not pack: no measure then
        return 1;
    }
    Workspace workspace({SolverKind::pcg, 1e-3, 1});
    const auto advance_by = [&](int steps) {
        for (int k = 0; k < steps; ++k)
            recycle(
                advance(state, model, ImposedStress{1}, {Scheme::implicit, 1e-2}, {}, workspace),
                workspace);
    };
    advance_by(block);
    std::array<double, 5> taken{};  // the median: other programs come and go
    for (double& seconds : taken) {
        const double begin = cpu_seconds();
        advance_by(block);
        seconds = cpu_seconds() - begin;
    }
    std::sort(taken.begin(), taken.end());
    const double n = parameters.particles;
    return taken[taken.size() / 2] /
           (block * reference * step_seconds(n, parameters.volume_fraction, "implicit", "pcg"));
}

std::vector<StepCost> cost(const Workflow& workflow, double machine, int threads)
{
    const Json resolved = workflow.resolved();
    Course course{resolved["suspension"], number(resolved["suspension"], "volume_fraction", 0.5),
                  true, std::max(1, threads)};
    std::vector<StepCost> result;
    for (std::size_t k = 0; k < workflow.steps.size(); ++k) {
        const Step& step = workflow.steps[k];
        const Json& parameters = resolved["steps"][k];
        StepCost one;
        if (step.kind == "pack") {
            course.volume_fraction = number(parameters, "volume_fraction",
                                            number(course.suspension, "volume_fraction", 0.5));
            course.from_packing = true;
            one.seconds = one.at_most =
                packing_seconds(step.needs.particles, course.volume_fraction);
        } else if (step.kind == "shear" || step.kind == "equilibrate") {
            one = shear_cost(parameters, step.needs, course);
            course.from_packing = false;
        } else if (step.kind == "step_stress" || step.kind == "jamming" ||
                   step.kind == "adaptive_flow_curve") {
            Course own = course;
            own.volume_fraction = number(course.suspension, "volume_fraction", 0.5);
            own.from_packing = true;
            one = ensemble_cost(parameters, step.needs, own);
        } else {
            one = other_cost(parameters, step.needs, course);
        }
        one.name = step.name;
        one.seconds *= machine;
        one.at_most *= machine;
        result.push_back(std::move(one));
    }
    return result;
}

}
