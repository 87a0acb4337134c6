// Step "stored_run": a run of another workflow, for the analysis steps after it.
#include "engine/archive.h"
#include "io/guarded.h"
#include "workflows/averages.h"
#include "workflows/steps.h"

#include <cmath>

namespace sigmaflow::workflows {

namespace {

/// Springs and repulsion carry all of the stress: what the jamming monitor asks for. The outcome of
/// a run is not stored in its file, but it ended there.
bool ended_jammed(const io::StoredRun& stored)
{
    constexpr double jammed_viscosity = 1e5;  // [eta0]
    const auto* stress = std::get_if<ImposedStress>(&stored.control);
    return stress && !stored.series.empty() &&
           stored.series.back().shear_rate * jammed_viscosity < stress->value;
}

/// As it was asked for: spheres and box meet it to rounding.
double asked(double volume_fraction)
{
    return std::round(volume_fraction * 1e9) / 1e9;
}

/// The last sample of a run that ended early is not at a multiple of the interval.
void keep_equal_intervals(std::vector<Sample>& series)
{
    if (series.size() < 3) return;
    const double interval = series[1].strain - series[0].strain;
    const double last = series.back().strain - series[series.size() - 2].strain;
    if (last < (1 - 1e-6) * interval) series.pop_back();
}

struct StoredRunStep {
    std::string file;
    std::filesystem::path path;  // known when the step is validated

    void describe(io::Fields& f)
    {
        f("file", file, 4096,
          "run.h5 of a step \"shear\"; relative to the folder of the workflow file")
            .require()
            .of_file();
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        path = plan.folder / file;
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error))
            throw node.member("file").wrong("must be a file, there is none of this name: " +
                                            path.string());
        const io::RunSummary summary = check(node);
        if (summary.frames == 0) throw node.member("file").wrong("has no frames");
        plan.inputs.push_back(path);
        plan.runs.push_back({.name = plan.step_name,
                             .control = summary.control,
                             .particles = static_cast<int>(summary.particles),
                             .volume_fraction = asked(summary.volume_fraction),
                             .narrowest_box = summary.narrowest_box,
                             .largest_radius = summary.largest_radius,
                             .strain = summary.strain,
                             .frames = static_cast<double>(summary.frames)});
        plan.needs.particles = static_cast<double>(summary.particles);
        plan.needs.frames_read = static_cast<double>(summary.frames);
    }

    /// In a process of its own: HDF5 can crash on a damaged file.
    io::RunSummary check(const io::JsonNode& node) const
    {
        io::RunSummary summary;
        try {
            const std::string bytes = io::guarded(path, io::limits_for(path), [&] {
                io::RunSummary found = io::check_run(path);
                ArchiveWriter a;
                a(found);
                return a.bytes();
            });
            ArchiveReader a(bytes);
            a(summary);
        } catch (const Error& error) {
            throw node.member("file").wrong(std::string("cannot be used: ") + error.what());
        }
        return summary;
    }

    void run(Context& context) const
    {
        io::StoredRun stored = io::read_run(path);
        const bool jammed = ended_jammed(stored);
        keep_equal_intervals(stored.series);
        Run run{.name = context.step_name,
                .control = stored.control,
                .volume_fraction = asked(stored.frames.front().volume_fraction),
                .particles = stored.frames.front().state.size(),
                .file = std::filesystem::absolute(path),
                .series = std::move(stored.series),
                .start_up = {},
                .jammed = jammed,
                .continues = {}};
        context.results["file"] = file;
        context.results["particles"] = run.particles;
        context.results["control"] = control_json(run.control);
        context.results["volume_fraction"] = run.volume_fraction;
        context.results["outcome"] = run.jammed ? "jammed" : "flowing";
        if (!run.jammed) {
            find_start_up(run);
            context.results.update(averages_json(run));
        }
        context.runs.push_back(std::move(run));
    }
};

}

StepKind stored_run_step()
{
    return step_kind<StoredRunStep>("stored_run",
                                    "a run of another workflow, for the steps that analyse it");
}

}
