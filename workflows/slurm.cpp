#include "workflows/slurm.h"

#include "io/atomic_file.h"

#include <sys/wait.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <sstream>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* folder_name = "slurm";
constexpr int not_found = 127;  // of a shell

constexpr const char* script_end = R"bash(
# SIGUSR1: the time is nearly over; SIGTERM: preempted. Both ask the point for a checkpoint.
child= asked=
hand_on() { asked=1; [ -z "$child" ] || kill -"$1" "$child" 2>/dev/null; }
trap 'hand_on USR1' USR1
trap 'hand_on TERM' TERM
"${command[@]}" </dev/null >>"points/$point.log" 2>&1 &
child=$!
[ -z "$asked" ] || kill -TERM "$child"
while :; do  # a signal ends wait before the point has ended
    wait "$child"
    code=$?
    [ -n "$asked" ] && [ "$code" -gt 128 ] || break
    asked=
done
echo "exit code $code" >>"points/$point.log"
case $code in
3 | 138 | 143)  # goes on later, unless the job was cancelled or is in the queue already
    task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
    [ "$(squeue -h -j "$task" -o %T)" != RUNNING ] || scontrol requeue "$task" ;;
esac
exit "$code"
)bash";

struct Answer {
    int code = 0;
    std::string text;
};

/// Runs a program of Slurm.
Answer ask(const std::vector<std::string>& words, bool with_errors = false)
{
    const std::string line = shell_line(words) + (with_errors ? " 2>&1" : " 2>/dev/null");
    FILE* pipe = popen(line.c_str(), "r");
    if (!pipe) return {not_found, ""};
    Answer answer;
    std::array<char, 4096> buffer{};
    while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
        answer.text.append(buffer.data(), count);
    const int status = pclose(pipe);
    answer.code = WIFEXITED(status) ? WEXITSTATUS(status) : not_found;
    while (answer.text.ends_with('\n')) answer.text.pop_back();
    return answer;
}

fs::path jobs_file(const SweepFolder& sweep)
{
    return sweep.path / folder_name / "jobs.json";
}

Json jobs_of(const SweepFolder& sweep)
{
    std::error_code error;
    if (!fs::exists(jobs_file(sweep), error)) return Json::array();
    const io::JsonDocument document = io::JsonDocument::read(jobs_file(sweep));
    for (const io::JsonNode& job : document.root().elements()) {
        const std::string id = job.member("id").text();
        if (id.empty() || id.find_first_not_of("0123456789") != std::string::npos)
            throw job.member("id").wrong("must be the number of a job");
        job.member("options").text();
        for (const io::JsonNode& point : job.member("points").elements()) point.text();
    }
    return Json::parse(document.text());
}

std::string job_name(const SweepFolder& sweep)
{
    std::string name = sweep.path.filename().string();
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name.empty() ? "sweep" : name;
}

/// The folder counts more, but for points that wait or run in the queue.
void add_state(PointStatus& status, const std::string& state)
{
    const bool runs =
        state == "RUNNING" || state == "COMPLETING" || state == "SUSPENDED" || state == "STOPPED";
    const bool waits = state == "PENDING" || state == "CONFIGURING" || state == "REQUEUED" ||
                       state == "REQUEUE_HOLD" || state == "SPECIAL_EXIT";
    if (status.state == PointState::complete) return;
    if (runs || waits) {
        status.state = runs ? PointState::running : PointState::waiting;
        status.queued = true;
        status.exit_code.reset();
        status.message.clear();
        return;
    }
    status.queued = false;
    if (status.state == PointState::failed || state == "COMPLETED" || state.empty()) return;
    const bool goes_on = state.starts_with("CANCELLED") || state == "TIMEOUT" ||
                         state == "PREEMPTED" || state == "NODE_FAIL";
    // what was killed with its log open still looks as if it ran
    if (!goes_on || status.state == PointState::running) status.state = PointState::failed;
    if (goes_on) status.state = PointState::interrupted;
    status.message = "Slurm: " + state;
}

std::vector<std::pair<std::string, std::string>> states_of_job(const std::string& id)
{
    std::vector<std::pair<std::string, std::string>> states;
    const Answer ended = ask({"sacct", "-n", "-P", "-X", "-j", id, "-o", "JobID,State"});
    if (ended.code == 0 && !ended.text.empty())
        states = slurm_states(ended.text);
    else
        states = slurm_job_states(ask({"scontrol", "-o", "show", "job", id}).text);
    const Answer live = ask({"squeue", "-h", "-r", "-j", id, "-o", "%i %T"});
    if (live.code == 0)
        for (auto& state : slurm_states(live.text)) states.push_back(std::move(state));
    return states;
}

std::string submit(const fs::path& script)
{
    const Answer answer = ask({"sbatch", "--parsable", script.string()}, true);
    if (answer.code == not_found)
        throw Error(ErrorKind::missing, "sbatch",
                    "is not on this machine or not in PATH; the job is in " + script.string() +
                        " (--no-submit only writes it)");
    // warnings may come before, and ";cluster" after the number
    const std::string last = answer.text.substr(answer.text.rfind('\n') + 1);
    const std::string id = last.substr(0, last.find(';'));
    if (answer.code != 0 || id.empty() || id.find_first_not_of("0123456789") != std::string::npos)
        throw Error(ErrorKind::file, script.string(), "sbatch does not take it: " + answer.text);
    return id;
}

}

std::string slurm_script(const SweepFolder& sweep, const std::vector<std::size_t>& points,
                         const SweepOptions& options, const fs::path& program)
{
    std::ostringstream text;
    text << "#!/bin/bash\n# made by sigmaflow sweep: one point a task\n"
         << "#SBATCH --job-name=" << job_name(sweep) << "\n#SBATCH --array=1-" << points.size();
    if (options.jobs > 0) text << "%" << options.jobs;
    text << "\n#SBATCH --cpus-per-task=" << options.threads
         << "\n#SBATCH --signal=B:USR1@120\n#SBATCH --requeue\n#SBATCH --open-mode=append\n"
         << "#SBATCH --chdir=" << shell_line({fs::absolute(sweep.path).string()})
         << "\n#SBATCH --output=" << folder_name << "/%A_%a.out\n";
    if (!options.slurm_options.empty()) text << "#SBATCH " << options.slurm_options << "\n";
    text << "case $SLURM_ARRAY_TASK_ID in\n";
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Point& point = sweep.points[points[k]];
        std::vector<std::string> words = run_arguments(point);
        words.insert(words.begin(), program.string());
        words.insert(words.end(),
                     {"--threads", std::to_string(options.threads), "--checkpoint-interval",
                      io::number_text(options.checkpoint_interval)});
        text << k + 1 << ") point=" << shell_line({point.name}) << " command=(" << shell_line(words)
             << ") ;;\n";
    }
    text << "*) echo \"no point has the number $SLURM_ARRAY_TASK_ID\" >&2; exit 64 ;;\nesac\n"
         << script_end;
    return text.str();
}

std::string write_slurm_job(const SweepFolder& sweep, const std::vector<std::size_t>& points,
                            const SweepOptions& options)
{
    if (options.slurm_options.find('\n') != std::string::npos)
        throw Error(ErrorKind::usage, "--slurm-options", "must be one line");
    if (points.empty()) return "no point is left to be submitted\n";
    Json jobs = jobs_of(sweep);
    SweepOptions now = options;
    if (now.slurm_options.empty() && !jobs.empty())
        now.slurm_options = jobs.back()["options"].get<std::string>();
    std::error_code error;
    fs::create_directories(sweep.path / folder_name, error);
    const fs::path script = sweep.path / folder_name / "job.sh";
    io::write_file(script, slurm_script(sweep, points, now, fs::read_symlink("/proc/self/exe")));
    if (!options.submit)
        return "job for " + std::to_string(points.size()) + " points in " + script.string() +
               "; submit it with: sbatch " + shell_line({script.string()}) + "\n";
    const std::string id = submit(script);
    Json names = Json::array();
    for (const std::size_t k : points) names.push_back(sweep.points[k].name);
    jobs.push_back({{"id", id}, {"options", now.slurm_options}, {"points", names}});
    io::write_file(jobs_file(sweep), jobs.dump(2) + "\n");
    return "job " + id + " with " + std::to_string(points.size()) +
           " points submitted; how far they are: sigmaflow collect " +
           shell_line({sweep.path.string()}) + "\n";
}

bool was_submitted(const SweepFolder& sweep)
{
    std::error_code error;
    return fs::exists(jobs_file(sweep), error);
}

void add_slurm_states(const SweepFolder& sweep, std::vector<PointStatus>& status)
{
    const Json jobs = jobs_of(sweep);
    if (jobs.empty()) return;
    std::map<std::string, std::size_t> numbers;
    for (std::size_t k = 0; k < sweep.points.size(); ++k) numbers[sweep.points[k].name] = k;
    for (const Json& job : jobs) {
        const std::string id = job["id"].get<std::string>();
        std::map<std::string, std::string> states;  // what comes later counts more
        for (const auto& [task, state] : states_of_job(id)) states[task] = state;
        for (std::size_t task = 0; task < job["points"].size(); ++task) {
            const auto point = numbers.find(job["points"][task].get<std::string>());
            const auto state = states.find(id + "_" + std::to_string(task + 1));
            if (point != numbers.end() && state != states.end())
                add_state(status[point->second], state->second);
        }
    }
}

std::vector<std::pair<std::string, std::string>> slurm_states(const std::string& printed)
{
    std::vector<std::pair<std::string, std::string>> result;
    std::istringstream lines(printed);
    for (std::string line; std::getline(lines, line);) {
        const auto mark = line.find_first_of(" |");
        if (mark != std::string::npos)
            result.emplace_back(line.substr(0, mark), line.substr(mark + 1));
    }
    return result;
}

std::vector<std::pair<std::string, std::string>> slurm_job_states(const std::string& printed)
{
    std::vector<std::pair<std::string, std::string>> result;
    std::istringstream lines(printed);
    for (std::string line; std::getline(lines, line);) {
        std::map<std::string, std::string> fields;
        std::istringstream words(line);
        for (std::string word; words >> word;)
            if (const auto equals = word.find('='); equals != std::string::npos)
                fields.emplace(word.substr(0, equals), word.substr(equals + 1));
        const std::string& task = fields["ArrayTaskId"];
        // tasks that wait stand together, "3-8": squeue tells them one by one
        if (!task.empty() && task.find_first_not_of("0123456789") == std::string::npos)
            result.emplace_back(fields["ArrayJobId"] + "_" + task, fields["JobState"]);
    }
    return result;
}

}
