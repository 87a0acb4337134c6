#include "workflows/sweep_run.h"

#include "workflows/collect.h"
#include "workflows/forecast.h"
#include "workflows/interruption.h"
#include "workflows/point_status.h"
#include "workflows/pool.h"
#include "workflows/progress.h"
#include "workflows/slurm.h"
#include "workflows/snakemake.h"
#include "workflows/workflow.h"

#include <algorithm>
#include <ostream>
#include <thread>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

std::vector<Job> jobs_of(const SweepFolder& sweep, const std::vector<std::size_t>& points,
                         const SweepOptions& options)
{
    const fs::path program = fs::read_symlink("/proc/self/exe"), folder = fs::absolute(sweep.path);
    std::vector<Job> jobs;
    for (const std::size_t k : points) {
        Job job{.command = run_arguments(sweep.points[k]),
                .folder = folder,
                .log = fs::absolute(sweep.log_of(sweep.points[k]))};
        job.command.insert(job.command.begin(), program.string());
        job.command.insert(job.command.end(),
                           {"--threads", std::to_string(options.threads), "--checkpoint-interval",
                            io::number_text(options.checkpoint_interval)});
        jobs.push_back(std::move(job));
    }
    return jobs;
}

/// [B], of the point that needs most.
double largest_memory(const SweepFolder& sweep, const std::vector<std::size_t>& points)
{
    double largest = 0;
    const fs::path file = sweep.path / frozen_name;
    for (const std::size_t k : points) {
        const auto document = io::JsonDocument::read(file, sweep.points[k].overrides);
        largest = std::max(largest, forecast(read_workflow(document, file)).memory);
    }
    return largest;
}

/// As many points at a time as there are cores and memory for, or as the options say. Error(input)
/// if these do not have room.
std::size_t width_of(const SweepFolder& sweep, const std::vector<std::size_t>& points,
                     const SweepOptions& options)
{
    const auto threads = static_cast<unsigned>(options.threads);
    const auto wanted = options.jobs > 0
                            ? static_cast<std::size_t>(options.jobs)
                            : std::max(1U, std::thread::hardware_concurrency() / threads);
    const std::size_t width = std::max<std::size_t>(1, std::min(wanted, points.size()));
    const double each = largest_memory(sweep, points);
    const Room room = room_here(sweep.path);
    if (!room.memory || each * static_cast<double>(width) <= *room.memory) return width;
    const auto fit = static_cast<std::size_t>(*room.memory / each);
    if (options.jobs > 0 && width > 1)
        throw Error(ErrorKind::input, "--jobs",
                    "must be <= " + std::to_string(std::max<std::size_t>(1, fit)) +
                        ", there is no memory for more points at a time, got " +
                        std::to_string(options.jobs));
    return std::max<std::size_t>(1, fit);  // a point that is too large says so itself
}

/// One view of all points.
class View {
public:
    View(const SweepFolder& sweep, std::vector<std::size_t> points, bool quiet)
        : sweep_(sweep),
          points_(std::move(points)),
          told_(points_.size(), false),
          progress_(Progress::for_stderr(quiet))
    {
        const std::size_t finished = sweep_.points.size() - points_.size();
        progress_.note("sweep of " + std::to_string(sweep_.points.size()) + " points in " +
                       sweep_.path.string() +
                       (finished ? ", " + std::to_string(finished) + " of an earlier run" : ""));
        progress_.begin("sweep");
    }

    void show(const PoolState& state)
    {
        for (std::size_t k = 0; k < points_.size(); ++k)
            if (state.codes[k] && !told_[k]) tell(k, *state.codes[k]);
        const std::size_t all = sweep_.points.size(), left = points_.size() - state.ended;
        const double done = static_cast<double>(all - left) / static_cast<double>(all);
        progress_.update(done, std::to_string(all - left - failed_) + " done, " +
                                   std::to_string(state.running) + " running, " +
                                   std::to_string(failed_) + " failed, " +
                                   std::to_string(left - state.running) + " left");
    }

    void end(const std::string& result) { progress_.end(result); }

private:
    void tell(std::size_t k, int code)
    {
        told_[k] = true;
        if (code == 0 || code == static_cast<int>(ErrorKind::interrupted)) return;
        ++failed_;
        const Point& point = sweep_.points[points_[k]];
        progress_.note(point.name + ": failed, exit code " + std::to_string(code) + ", see " +
                       sweep_.log_of(point).string());
    }

    const SweepFolder& sweep_;
    std::vector<std::size_t> points_;
    std::vector<bool> told_;
    std::size_t failed_ = 0;
    Progress progress_;
};

/// After all points that could run have run.
void throw_worst(const SweepFolder& sweep, const std::vector<PointStatus>& status,
                 const std::optional<std::string>& asked)
{
    const PointStatus* worst = nullptr;
    std::size_t failed = 0, worst_point = 0;
    bool unfinished = false;
    for (std::size_t k = 0; k < status.size(); ++k) {
        unfinished = unfinished || (status[k].state != PointState::complete &&
                                    status[k].state != PointState::failed);
        if (status[k].state != PointState::failed) continue;
        ++failed;
        if (worst && *worst->exit_code >= *status[k].exit_code) continue;
        worst = &status[k];
        worst_point = k;
    }
    if (unfinished)
        throw Error(ErrorKind::interrupted, asked.value_or("a point was stopped"),
                    count_text(status) + "; the same command goes on");
    if (!worst) return;
    throw Error(static_cast<ErrorKind>(*worst->exit_code), sweep.path.string(),
                std::to_string(failed) + " of " + std::to_string(status.size()) +
                    " points failed, all others are complete; the worst, " +
                    sweep.points[worst_point].name + ": " + failure_text(*worst));
}

void run_here(const SweepFolder& sweep, const std::vector<std::size_t>& points,
              const SweepOptions& options, std::ostream& results)
{
    const Interruption interruption(options.wall_time);
    const std::size_t width = width_of(sweep, points, options);
    const std::vector<Job> jobs = jobs_of(sweep, points, options);
    View view(sweep, points, options.quiet);
    std::optional<std::string> asked;
    run_pool(
        jobs, width, static_cast<int>(ErrorKind::locked),
        [&] {
            if (!asked) asked = interruption.asked();
            return asked.has_value();
        },
        [&](const PoolState& state) { view.show(state); });
    const std::vector<PointStatus> status = read_status(sweep);
    view.end(count_text(status));
    results << collect_sweep(sweep, status, options.quantity) << std::flush;
    throw_worst(sweep, status, asked);
}

/// Numbers of the points that are neither complete nor in a queue.
std::vector<std::size_t> points_left(const std::vector<PointStatus>& status)
{
    std::vector<std::size_t> points;
    for (std::size_t k = 0; k < status.size(); ++k)
        if (status[k].state != PointState::complete && !status[k].queued) points.push_back(k);
    return points;
}

void refuse_queued(const SweepFolder& sweep, const std::vector<PointStatus>& status)
{
    const auto count = std::count_if(status.begin(), status.end(),
                                     [](const PointStatus& one) { return one.queued; });
    if (count > 0)
        throw Error(ErrorKind::locked, sweep.path.string(),
                    std::to_string(count) +
                        " points wait or run in Slurm: cancel them there first, or use --engine "
                        "slurm");
}

}

void run_sweep(const SweepOptions& options, std::ostream& results)
{
    SweepFolder sweep = planned_sweep(options);
    const SweepLock lock(sweep.path);
    if (holds_sweep(sweep.path)) {
        const SweepFolder before = read_sweep(sweep.path);
        refuse_other_sweep(before, sweep);
        sweep.source = before.source;
    }
    write_sweep(sweep);
    std::vector<PointStatus> status = read_status(sweep);
    add_slurm_states(sweep, status);
    const Engine engine =
        options.engine.value_or(was_submitted(sweep) ? Engine::slurm : Engine::local);
    const std::vector<std::size_t> points = points_left(status);
    if (engine == Engine::slurm) {
        results << count_text(status) << "\n" << write_slurm_job(sweep, points, options);
        return;
    }
    refuse_queued(sweep, status);
    if (engine == Engine::snakemake)
        results << write_snakefile(sweep, options);
    else
        run_here(sweep, points, options, results);
}

}
