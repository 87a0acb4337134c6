#include "workflows/shearing.h"

#include "engine/memory.h"
#include "workflows/recorder.h"
#include "workflows/start.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sigmaflow::workflows {

namespace {

constexpr double jammed_viscosity = 1e5;  // [eta0]
constexpr double most_outputs = 1e7;

std::string details_text(const State& state, double shear_rate)
{
    char text[80];
    std::snprintf(text, sizeof text, "strain %.3f, shear rate %.4g", state.strain, shear_rate);
    return text;
}

}

void describe_scheme(io::Fields& f, Scheme& scheme)
{
    f("scheme", scheme,
      io::Words<Scheme>{
          {"implicit", Scheme::implicit}, {"heun", Scheme::heun}, {"euler", Scheme::euler}},
      "time stepping: implicit contact springs (long steps), predictor-corrector, or Euler; the "
      "dashpot variant needs one of the last two");
}

void check_scheme(Scheme scheme, const Model& model, const io::JsonNode& step)
{
    if (scheme == Scheme::implicit && model.contact_hydrodynamics == ContactHydrodynamics::dashpot)
        throw step.error_at_key("scheme",
                                "\"implicit\" (the default) needs contact_hydrodynamics "
                                "\"lubrication\"; \"heun\" can do \"dashpot\"");
}

void ShearingParameters::describe(io::Fields& f)
{
    f("stress", stress, io::between(1e-6, 1e9), "sigma0",
      "imposed shear stress; either this or rate");
    f("rate", rate, io::between(1e-6, 1e9), "rate0", "imposed shear rate; either this or stress");
    describe_scheme(f, scheme);
    f("displacement", displacement, io::above_to(0, 0.1), "a",
      "nothing moves by more than this in one step; default: 0.01, heun and euler 0.001");
    f("solver", solver,
      io::Words<SolverKind>{{"pcg", SolverKind::pcg},
                            {"cholesky", SolverKind::cholesky},
                            {"lagged_cholesky", SolverKind::lagged_cholesky}},
      "resistance problem: conjugate gradients preconditioned by an incomplete factor, a direct "
      "factorisation, or conjugate gradients preconditioned by an earlier factorisation");
    f("solver_tolerance", solver_tolerance, io::between(1e-12, 1e-2), "-",
      "relative residual at which an iteration of a step stops; the error of the shear rate is far "
      "smaller, and samples are solved to 1e-8; default: 0.001, heun and euler 1e-5");
    f("series_interval", series_interval, io::between(1e-6, 1e3), "strain",
      "strain between two rows of the time series");
    f("maximum_time", maximum_time, io::above(0), "1/rate0",
      "ends the step in any case; default: strain * 1e5/stress, or 1.01 * strain/rate");
    model.describe(f);
}

Control ShearingParameters::check(const io::JsonNode& node, Plan& plan, double strain) const
{
    plan.need_state(node);
    const Model changed = checked_model(model, node, plan);
    const Control control = io::checked_control(stress, rate, changed, node);
    check_scheme(scheme, changed, node);
    if (strain / series_interval > most_outputs)
        throw node.error_at_key("series_interval", "gives more than 1e7 rows, the strain is " +
                                                       io::number_text(strain));
    plan.needs.volume_fraction = plan.volume_fraction;
    plan.needs.samples = std::floor(strain / series_interval) + 2;
    return control;
}

ShearingTask ShearingParameters::task(const Model& of_suspension, double strain,
                                      double frame_interval, int threads) const
{
    const bool long_steps = scheme == Scheme::implicit;
    return {.model = model.applied_to(of_suspension),
            .control = rate ? Control(ImposedRate{*rate}) : Control(ImposedStress{*stress}),
            .stepping = {scheme, displacement.value_or(long_steps ? 1e-2 : 1e-3)},
            .solver = {solver, solver_tolerance.value_or(long_steps ? 1e-3 : 1e-5), threads},
            .strain = strain,
            .time = time_limit(strain),
            .series_interval = series_interval,
            .frame_interval = frame_interval};
}

double ShearingParameters::time_limit(double strain) const
{
    if (maximum_time) return *maximum_time;
    return stress ? strain * jammed_viscosity / *stress : 1.01 * strain / *rate;
}

std::string_view outcome_name(Outcome outcome)
{
    switch (outcome) {
        case Outcome::flowing:
            return "flowing";
        case Outcome::jammed:
            return "jammed";
        case Outcome::undecided:
            break;
    }
    return "undecided";
}

namespace {

std::optional<JammingMonitor> monitor_of(const Control& control)
{
    const auto* stress = std::get_if<ImposedStress>(&control);
    if (!stress) return std::nullopt;
    return JammingMonitor(stress->value, {.viscosity = jammed_viscosity});
}

/// A shearing step on its way.
struct Voyage {
    Workspace workspace;
    Recorder recorder;
    std::optional<JammingMonitor> monitor;
    ShearingResult result = {};
    bool jammed = false;

    template <class Archive>
    void archive(Archive& a)
    {
        a(recorder, result.steps, result.solver, jammed);
        if (monitor) a(*monitor);
    }
};

std::string stored(const State& state, Voyage& voyage)
{
    ArchiveWriter a;
    a(state, voyage);
    save_memory(state, voyage.workspace, a);
    return a.bytes();
}

void restore(const std::string& bytes, const Model& model, State& state, Voyage& voyage)
{
    const int particles = state.size();
    ArchiveReader a(bytes);
    a(state, voyage);
    if (state.size() != particles) ArchiveReader::refuse("has another number of particles");
    restore_memory(state, model, voyage.workspace, a);
    a.finish();
}

/// Goes from one output to the next until the end; after_step(shear_rate) after each step.
template <class AfterStep>
void travel(State& state, const ShearingTask& task, Voyage& voyage, AfterStep&& after_step)
{
    const Model& model = task.model;
    ShearingResult& result = voyage.result;
    for (;;) {
        const auto recorded = voyage.recorder.record(state, model, voyage.workspace);
        if (voyage.recorder.last()) break;
        if (voyage.jammed) {
            voyage.recorder.record_end(state, model, voyage.workspace);
            result.outcome = Outcome::jammed;
            break;
        }
        Evaluation moved = advance(state, model, task.control, task.stepping,
                                   {voyage.recorder.target(), task.time}, voyage.workspace,
                                   recorded ? &*recorded : nullptr);
        ++result.steps;
        result.solver.add(moved.solve);
        voyage.jammed = voyage.monitor && voyage.monitor->observe(state, moved);
        const double shear_rate = moved.shear_rate;
        recycle(std::move(moved), voyage.workspace);
        after_step(shear_rate);
    }
    if (voyage.recorder.arrived()) result.outcome = Outcome::flowing;
    if (voyage.monitor && voyage.monitor->last_window().duration > 0)
        result.window = voyage.monitor->last_window();
}

Error located(const Error& error, const State& state, const ShearingResult& result)
{
    return error.within("at strain " + io::number_text(state.strain) + ", step " +
                        std::to_string(result.steps));
}

}

ShearingResult shear(Context& context, const ShearingTask& task, RunFiles& files,
                     const std::function<bool()>& enough)
{
    State& state = context.state;
    const Outputs outputs{
        [&](const Sample& sample, bool on_grid) { files.append(sample, on_grid); },
        [&](const Frame& frame) { files.append(frame); }};
    Voyage voyage{Workspace(task.solver), Recorder(task, outputs, enough),
                  monitor_of(task.control)};
    if (const Checkpoint* saved = context.keeper.saved())
        restore(saved->run, task.model, state, voyage);
    else
        state.strain = state.time = 0;
    try {
        travel(state, task, voyage, [&](double shear_rate) {
            context.progress.update(std::max(state.strain / task.strain, state.time / task.time),
                                    details_text(state, shear_rate));
            if (context.keeper.due())
                context.keeper.keep(state.strain, files.marks(), stored(state, voyage));
        });
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::numerics) throw;
        const auto dump = files.write_failure(state);
        const Error where = located(error, state, voyage.result);
        throw Error(ErrorKind::numerics, where.where(),
                    where.problem() + "; the state before is in " + dump.string());
    }
    return voyage.result;
}

Trial try_shear(State& state, const ShearingTask& task, const std::function<void()>& after_step)
{
    Trial trial;
    const Outputs outputs{[&](const Sample& sample, bool) { trial.series.push_back(sample); }};
    const std::function<bool()> never;
    Voyage voyage{Workspace(task.solver), Recorder(task, outputs, never), monitor_of(task.control)};
    state.strain = state.time = 0;
    try {
        travel(state, task, voyage, [&](double) { after_step(); });
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::numerics) throw;
        throw located(error, state, voyage.result);
    }
    trial.result = voyage.result;
    return trial;
}

nlohmann::ordered_json shearing_json(const State& state, const ShearingResult& result)
{
    nlohmann::ordered_json json;
    json["outcome"] = outcome_name(result.outcome);
    json["strain"] = state.strain;
    json["time"] = state.time;
    json["steps"] = result.steps;
    json["solver"] = {{"mean_iterations", result.solver.iterations / std::max(1L, result.steps)},
                      {"largest_residual", result.solver.largest_residual},
                      {"fall_backs", result.solver.fall_backs}};
    if (const auto& window = result.window)
        json["jamming_window"] = {{"duration", window->duration},
                                  {"strain_gain", window->strain_gain},
                                  {"mean_viscosity", window->mean_viscosity},
                                  {"force_residual", window->force_residual}};
    return json;
}

}
