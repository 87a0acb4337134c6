// workflows/slurm.h -- a sweep as a job array of Slurm, one point a task.
//
// slurm/job.sh holds the points of the tasks and their commands. A task that is asked to stop, by
// SIGUSR1 two minutes before the end of its time or by SIGTERM when it is preempted, hands that on
// to its point, which stores a checkpoint and ends with exit code 3; then the task puts itself back
// into the queue, unless Slurm has already done so or the job was cancelled. Tasks can be run any
// number of times. slurm/jobs.json remembers which job has which points and
// the options for sbatch, which the next one has as well if it is given none.
#pragma once
#include "workflows/point_status.h"
#include "workflows/sweep_run.h"

namespace sigmaflow::workflows {

/// The text of slurm/job.sh.
std::string slurm_script(const SweepFolder& sweep, const std::vector<std::size_t>& points,
                         const SweepOptions& options, const std::filesystem::path& program);

/// Writes the job and, if the options say so, submits it. Returns what is to be said. Errors:
/// missing (no sbatch), file (sbatch refuses the job).
std::string write_slurm_job(const SweepFolder& sweep, const std::vector<std::size_t>& points,
                            const SweepOptions& options);

/// Was the sweep submitted to Slurm before?
bool was_submitted(const SweepFolder& sweep);

/// What Slurm knows of the points: squeue tells which tasks wait and run, sacct how others ended,
/// without accounting `scontrol show job`. What the folders say of complete and failed points
/// counts more. Nothing changes where there is no Slurm.
void add_slurm_states(const SweepFolder& sweep, std::vector<PointStatus>& status);

/// "12_3" and its state "RUNNING", as `squeue -h -r -o "%i %T"` and `sacct -n -P -X -o JobID,State`
/// print them.
std::vector<std::pair<std::string, std::string>> slurm_states(const std::string& printed);

/// The same of `scontrol -o show job`.
std::vector<std::pair<std::string, std::string>> slurm_job_states(const std::string& printed);

}
