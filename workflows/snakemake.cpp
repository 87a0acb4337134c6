#include "workflows/snakemake.h"

#include "io/atomic_file.h"

namespace sigmaflow::workflows {

namespace fs = std::filesystem;

namespace {

/// JSON texts in ASCII are texts of Python, too.
std::string python_text(const std::string& text)
{
    return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

}

std::string snakefile(const SweepFolder& sweep, const SweepOptions& options,
                      const fs::path& program)
{
    const std::string sigmaflow = shell_line({program.string()});
    std::string text =
        "# made by sigmaflow sweep\n"
        "# snakemake --cores 4 --keep-going --rerun-incomplete   in this folder\n\nPOINTS = {\n";
    for (const Point& point : sweep.points)
        text += "    " + python_text(point.name) + ": " +
                python_text(shell_line(run_arguments(point))) + ",\n";
    text +=
        "}\nDONE = expand(\"points/{point}.done\", point=POINTS)\n\n"
        "rule all:\n    input: DONE, \"table.done\"\n\n"
        "rule table:\n    input: DONE\n    output: touch(\"table.done\")\n"
        "    params: program=" +
        python_text(sigmaflow) +
        "\n    shell: \"{params.program} collect .\"\n\n"
        "rule point:\n    output: touch(\"points/{point}.done\")\n"
        "    wildcard_constraints: point=\"[^/]+\"\n    threads: " +
        std::to_string(options.threads) +
        "\n    params:\n        program=" + python_text(sigmaflow) +
        ",\n        arguments=lambda wildcards: POINTS[wildcards.point],\n"
        "    shell:\n"
        "        \"code=0; \"\n"
        "        \"{params.program} {params.arguments} --threads {threads}";
    text += " --checkpoint-interval " + io::number_text(options.checkpoint_interval) +
            " </dev/null >>points/{wildcards.point}.log 2>&1 || code=$?; \"\n"
            "        \"echo exit code $code >>points/{wildcards.point}.log; exit $code\"\n";
    return text;
}

std::string write_snakefile(const SweepFolder& sweep, const SweepOptions& options)
{
    const fs::path file = sweep.path / "Snakefile";
    io::write_file(file, snakefile(sweep, options, fs::read_symlink("/proc/self/exe")));
    std::vector<std::string> command{"snakemake", "--directory", sweep.path.string(), "--snakefile",
                                     file.string()};
    command.insert(command.end(),
                   {"--cores", options.jobs > 0 ? std::to_string(options.jobs) : "all"});
    command.insert(command.end(), {"--keep-going", "--rerun-incomplete"});
    return file.string() + " written; run it, or what is left of it, with\n" + shell_line(command) +
           "\n";
}

}
