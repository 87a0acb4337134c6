// Step "stored_state": the state of a file or of a stored frame, for the shearing steps after it.
#include "engine/archive.h"
#include "io/atomic_file.h"
#include "io/case_file.h"
#include "io/guarded.h"
#include "workflows/pictures.h"
#include "workflows/start.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

constexpr double rounding = 1e-9;

/// What has been said of the suspension must be so in the file.
void check_agreement(const io::JsonNode& step, const Plan& plan)
{
    const Suspension& suspension = plan.suspension;
    if (suspension.says_particles && suspension.packing.particles != plan.particles)
        throw step.error("has " + std::to_string(plan.particles) +
                         " particles, the suspension says " +
                         std::to_string(suspension.packing.particles) +
                         ": leave it out there, the file says it");
    if (suspension.says_volume_fraction &&
        std::abs(suspension.packing.volume_fraction - plan.volume_fraction) > rounding)
        throw step.error("has the volume fraction " + io::number_text(plan.volume_fraction) +
                         ", the suspension says " +
                         io::number_text(suspension.packing.volume_fraction) +
                         ": leave it out there, the file says it");
}

const Frame& nearest_frame(const io::StoredRun& run, const std::optional<double>& strain)
{
    if (!strain) return run.frames.back();
    const auto distance = [&](const Frame& f) { return std::abs(f.state.strain - *strain); };
    return *std::min_element(
        run.frames.begin(), run.frames.end(),
        [&](const Frame& a, const Frame& b) { return distance(a) < distance(b); });
}

struct StoredState {
    std::string file, of;
    std::optional<double> strain;
    std::filesystem::path path;  // of the file, known when the step is validated
    bool is_run = false;         // the file is a run.h5

    void describe(io::Fields& f)
    {
        f("file", file, 4096,
          "state.json of any step, or run.h5 of a step \"shear\"; relative to the folder of the "
          "workflow file. It says particles, radii, box and the springs of the contacts; the "
          "model is that of the suspension of this workflow")
        .of_file();
        f("of", of, 64,
          "instead of file: name of a step \"shear\" of this workflow; default without file: the "
          "last one before this step");
        f("strain", strain, io::between(0, 1e4), "-",
          "of a run: take the stored frame nearest to this strain; default: the last one");
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        plan.need_suspension(node);
        if (!file.empty() && node.has("of"))
            throw node.error_at_key("of", "file already says where the state comes from");
        if (file.empty()) {
            const PlannedRun run = plan.need_run(node, of, true);
            check_within(run, node, "strain", strain);
            take(run, plan);
        } else {
            path = plan.folder / file;
            check_file(node, plan);
            plan.inputs.push_back(path);
            check_agreement(node, plan);
        }
        check_box(node, plan);
        plan.has_state = plan.changes_state = true;
    }

    static void take(const PlannedRun& run, Plan& plan)
    {
        plan.particles = run.particles;
        plan.volume_fraction = run.volume_fraction;
        plan.narrowest_box = run.narrowest_box;
        plan.largest_radius = run.largest_radius;
    }

    void check_file(const io::JsonNode& node, Plan& plan)
    {
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error))
            throw node.member("file").wrong("must be a file, there is none of this name: " +
                                            path.string());
        is_run = io::first_bytes(path, 8) == "\x89HDF\r\n\x1a\n";
        try {
            if (is_run)
                check_run_file(node, plan);
            else
                check_case_file(node, plan);
        } catch (const Error& problem) {
            if (problem.where().find(path.string()) == std::string::npos) throw;
            throw node.member("file").wrong(std::string("cannot be used: ") + problem.what());
        }
    }

    /// In a process of its own: HDF5 can crash on a damaged file.
    void check_run_file(const io::JsonNode& node, Plan& plan) const
    {
        const std::string bytes = io::guarded(path, io::limits_for(path), [&] {
            io::RunSummary found = io::check_run(path);
            ArchiveWriter a;
            a(found);
            return a.bytes();
        });
        io::RunSummary summary;
        ArchiveReader a(bytes);
        a(summary);
        if (summary.frames == 0) throw node.member("file").wrong("has no frames");
        take({.name = file,
              .control = summary.control,
              .particles = static_cast<int>(summary.particles),
              .volume_fraction = as_asked(summary.volume_fraction),
              .narrowest_box = summary.narrowest_box,
              .largest_radius = summary.largest_radius,
              .strain = summary.strain,
              .frames = static_cast<double>(summary.frames)},
             plan);
        if (strain && *strain > summary.strain + rounding)
            throw node.member("strain").wrong("must be <= " + io::number_text(summary.strain) +
                                              ", the strain of the last frame");
        plan.needs.frames_read = static_cast<double>(summary.frames);
    }

    void check_case_file(const io::JsonNode& node, Plan& plan) const
    {
        if (strain)
            throw node.error_at_key("strain", "is for a run.h5, this file has one state only");
        const State state = read_state_file().state;
        plan.particles = state.size();
        plan.volume_fraction = as_asked(sigmaflow::volume_fraction(state));
        plan.narrowest_box = state.box.length.minCoeff();
        plan.largest_radius = *std::max_element(state.radius.begin(), state.radius.end());
    }

    static void check_box(const io::JsonNode& node, const Plan& plan)
    {
        const double least = narrowest_box_allowed(plan.largest_radius, plan.suspension.model);
        if (plan.narrowest_box < least * (1 - rounding))
            throw node.error("the box is " + short_number(plan.narrowest_box) +
                             " a wide, must be >= " + io::number_text(least) +
                             " a, twice the distance up to which two of the largest spheres "
                             "interact");
    }

    io::Case read_state_file() const
    {
        const io::JsonDocument document = io::JsonDocument::read(path);
        return io::read_case(document.root());
    }

    void run(Context& context) const
    {
        nlohmann::ordered_json& results = context.results;
        Model model;
        State& state = context.state;
        if (!file.empty() && !is_run) {
            io::Case stored = read_state_file();
            state = std::move(stored.state);
            model = stored.model;
            results["file"] = file;
        } else {
            const io::StoredRun stored = io::read_run(file.empty() ? context.run(of).file : path);
            if (stored.frames.empty())
                throw Error(ErrorKind::internal, path.string(), "has no frames");
            state = nearest_frame(stored, strain).state;
            model = stored.model;
            results[file.empty() ? "of" : "file"] = file.empty() ? of : file;
            results["strain"] = state.strain;
        }
        state.strain = state.time = state.time_step = 0;
        context.last_run.clear();  // it may be a frame from the middle of a run
        io::write_case(context.folder.file(context.step_name + "/state.json"), state,
                       context.suspension.model, ImposedStress{1});
        results["particles"] = state.size();
        results["volume_fraction"] = sigmaflow::volume_fraction(state);
        const Vec3& box = state.box.length;
        results["box"] = {box.x(), box.y(), box.z()};
        results["contacts"] = state.contacts.size();
        const auto changed = model_changes(model, context.suspension.model);
        if (!changed.empty()) results["model_changed"] = changed;
    }

    /// {"friction_static": [before, now], ...}: the model is not that of the stored run.
    static nlohmann::ordered_json model_changes(Model before, Model now)
    {
        io::Fields old_fields, new_fields;
        io::describe(old_fields, before);
        io::describe(new_fields, now);
        const auto old_values = io::write_fields(old_fields.list());
        const auto new_values = io::write_fields(new_fields.list());
        nlohmann::ordered_json changes = nlohmann::ordered_json::object();
        for (const auto& [name, value] : new_values.items())
            if (old_values.at(name) != value) changes[name] = {old_values.at(name), value};
        return changes;
    }
};

}

StepKind stored_state_step()
{
    return step_kind<StoredState>(
        "stored_state", "the state of a file or of a stored frame, to go on from in other ways");
}

}
