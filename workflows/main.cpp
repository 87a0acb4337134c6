// The program `sigmaflow`: the command line, the only catch and the only exit code.
#include "engine/error.h"
#include "io/case_file.h"
#include "workflows/blas_kernel.h"
#include "workflows/help.h"
#include "workflows/interruption.h"
#include "workflows/manifest.h"
#include "workflows/report_page.h"
#include "workflows/runner.h"
#include "workflows/validate.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <optional>

namespace {

using namespace sigmaflow;

constexpr const char* examples = R"(examples:
  sigmaflow run workflows/quickstart.json             results in out/quickstart
  sigmaflow run my_flow.json --out results/phi_0.56   results in a folder of your choice
  sigmaflow steps                                     all steps, the suspension and the model
  sigmaflow steps shear                               the parameters of one step
  sigmaflow report out/quickstart                     one HTML page of a run: report.html
  sigmaflow evaluate case.json                        velocities and stress of one configuration
  sigmaflow validate my_flow.json out/a/shear/run.h5  what files are, or what is wrong with them

a run that was interrupted or killed goes on with the same command

exit codes: 0 complete, 3 interrupted (the same command goes on), 64 wrong command line, 65 invalid
input, 66 input missing, 69 pictures could not be drawn, 70 numerical failure, 71 internal error,
73 cannot write, 74 disk full, 75 folder in use)";

constexpr const char* report_examples = R"(examples:
  sigmaflow report out/quickstart                     writes out/quickstart/report.html
  sigmaflow report out/quickstart --out run.html      writes a page to send; its pictures are inside

the run may be complete, interrupted, failed or going on

exit codes: 0 written, 64 wrong command line, 65 not a run or damaged, 66 no such folder, 73 cannot
write, 74 disk full)";

/// Prints results; a full disk or a closed pipe must not pass for success.
void print(const std::string& text)
{
    std::cout << text << std::flush;
    if (!std::cout) throw Error(ErrorKind::file, "standard output", "cannot be written");
}

int complain(const std::string& message, ErrorKind kind)
{
    const char* what = kind == ErrorKind::interrupted ? "interrupted: " : "error: ";
    std::cerr << "sigmaflow: " << what << message << "\n";
    return static_cast<int>(kind);
}

/// One line for each good file, an error for each bad one; the last error is thrown.
void validate_files(const std::vector<std::string>& files)
{
    std::optional<Error> last;
    for (const std::string& file : files) {
        try {
            print(workflows::validate_file(file) + "\n");
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::input && error.kind() != ErrorKind::missing) throw;
            if (last) complain(last->what(), last->kind());
            last = error;
        }
    }
    if (last) throw *last;
}

void run_command(int argc, char** argv)
{
    CLI::App app("sigmaflow: dense frictional suspensions sheared at an imposed stress");
    app.footer(examples);
    app.set_version_flag("--version", "sigmaflow " + workflows::version());
    app.require_subcommand(0, 1);

    workflows::RunOptions options;
    std::string out, folder, case_file, step, wall_time;
    std::vector<std::string> files;
    CLI::App* run = app.add_subcommand("run", "run a workflow");
    run->add_option("WORKFLOW.json", options.workflow, "the workflow")->required();
    run->add_option(
        "--out", out,
        "folder for the results, default out/<name of the workflow file>. An earlier run of the "
        "same workflow in it goes on where it ended, any other folder must be empty");
    run->add_flag("--force", options.force,
                  "run all steps anew, even if the folder has their results or a checkpoint");
    run->add_option("--checkpoint-interval", options.checkpoint_interval,
                    "seconds between two checkpoints; 0: after every step")
        ->check(CLI::Range(0., 1e6))
        ->default_val(30);
    run->add_option("--max-walltime", wall_time,
                    "store a checkpoint and end with exit code 3 in good time before, e.g. 90m, 2h "
                    "or 1-12:00:00");
    run->add_option("--threads", options.threads,
                    "threads of each evaluation, worth it from some thousand particles on; results "
                    "do not depend on it")
        ->check(CLI::Range(1, 256))
        ->default_val(1);
    run->add_flag("-q,--quiet", options.quiet, "no progress, only results and errors");
    CLI::App* evaluate = app.add_subcommand("evaluate", "evaluate one configuration, print JSON");
    evaluate->add_option("CASE.json", case_file, "the configuration")->required();
    CLI::App* validate = app.add_subcommand(
        "validate", "check workflows, cases, runs (.h5) and VTK files, compute nothing");
    validate->add_option("FILE", files, "the files")->required();
    CLI::App* report = app.add_subcommand("report", "one HTML page of what a run has found");
    report->add_option("DIR", folder, "the folder of the run")->required();
    report->add_option("--out", out, "the page, default DIR/report.html");
    report->footer(report_examples);
    CLI::App* steps = app.add_subcommand("steps", "explain steps and parameters");
    steps->add_option("STEP", step, "a step; default: all");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help_or_version) {
        app.exit(help_or_version);
        return print("");
    }

    if (run->parsed()) {
        if (run->count("--out")) options.out = out;
        if (run->count("--max-walltime")) {
            options.wall_time = workflows::seconds_of(wall_time);
            if (!options.wall_time)
                throw Error(
                    ErrorKind::usage, "--max-walltime",
                    "must be a time as 5400, 90m, 2h or D-HH:MM:SS, got \"" + wall_time + "\"");
        }
        if (options.out && options.out->empty())
            throw Error(ErrorKind::usage, "--out", "must name a folder, got \"\"");
        workflows::run_workflow(options, std::cout);
        print("");
    } else if (evaluate->parsed()) {
        print(io::evaluate_case(case_file));
    } else if (validate->parsed()) {
        validate_files(files);
    } else if (report->parsed()) {
        if (report->count("--out") && out.empty())
            throw Error(ErrorKind::usage, "--out", "must name a file, got \"\"");
        print(workflows::write_report_page(folder, out).string() + "\n");
    } else if (steps->parsed()) {
        print(workflows::steps_help(step));
    } else {
        print(app.help());
    }
}

}

int main(int argc, char** argv)
{
    workflows::choose_blas_kernel(argv);
    try {
        run_command(argc, argv);
        return 0;
    } catch (const CLI::ParseError& error) {
        return complain(std::string(error.what()) + " (sigmaflow --help)", ErrorKind::usage);
    } catch (const Error& error) {
        return complain(error.what(), error.kind());
    } catch (const std::exception& error) {
        return complain(std::string("internal error: ") + error.what(), ErrorKind::internal);
    } catch (...) {
        return complain("internal error of unknown kind", ErrorKind::internal);
    }
}
