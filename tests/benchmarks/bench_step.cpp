// bench_step -- cost of whole steps, as one JSON line per solver.
//
//   bench_step --particles 500 --volume-fraction 0.58 --stress 2 --pre-shear 0.8 --steps 300
//   bench_step --state thick.json --steps 300 --solver cholesky --solver pcg --tolerance 1e-4
//
// Every time is CPU time of the computing thread, or wall time with several threads. All solvers
// start from the same state. "pairs": candidates of the neighbour list; "core_memory_MB": what the
// steps keep resident (workspace, moved states), the state itself not counted.
#include "engine/packing.h"
#include "engine/step.h"
#include "engine/workspace.h"
#include "io/case_file.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

using namespace sigmaflow;

namespace {

struct Options {
    int particles = 500, steps = 1000000;
    double volume_fraction = 0.58, stress = 2, pre_shear = 0.3, displacement = 1e-3;
    double normal_stiffness = 400, debye_length = 0.05, tolerance = 1e-4;
    double strain = 0.01;
    int threads = 1;
    std::string scheme = "heun";
    std::string state, save;
    std::vector<std::string> solvers{"pcg"};
};

// of this thread, or of the wall when several work
double seconds(bool wall)
{
    timespec t;
    clock_gettime(wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double resident_MB()
{
    long total = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> total >> resident;
    return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) / (1024 * 1024);
}

Model model_of(const Options& o)
{
    Model m;
    m.stiffness_scale = StiffnessScale::fixed;
    m.normal_stiffness = o.normal_stiffness;
    m.tangential_stiffness = o.normal_stiffness / 2;
    m.debye_length = o.debye_length;
    return m;
}

State start_of(const Options& o, const Model& m)
{
    if (!o.state.empty()) {
        const auto document = io::JsonDocument::read(o.state);
        return io::read_case(document.root()).state;
    }
    PackingParameters p;
    p.particles = o.particles;
    p.volume_fraction = o.volume_fraction;
    State s = random_packing(p);
    const Control control = ImposedStress{o.stress};
    Workspace workspace({SolverKind::pcg, 1e-4});
    while (s.strain < o.pre_shear)
        advance(s, m, control, {Scheme::implicit, 5e-3}, {o.pre_shear}, workspace);
    if (!o.save.empty()) io::write_case(o.save, s, m, control);
    return s;
}

void measure(const Options& o, const Model& m, State s, const std::string& name)
{
    const SolverSettings settings{name == "cholesky"          ? SolverKind::cholesky
                                  : name == "lagged_cholesky" ? SolverKind::lagged_cholesky
                                                              : SolverKind::pcg,
                                  o.tolerance, o.threads};
    const Control control = ImposedStress{o.stress};
    malloc_trim(0);  // memory of the pre-shear would be used again unseen
    const double resident_before = resident_MB();
    Workspace workspace(settings);
    const Stepping stepping{o.scheme == "implicit" ? Scheme::implicit : Scheme::heun,
                            o.displacement};
    // a few steps first: the pattern is analysed and the buffers grow
    for (int k = 0; k < std::min(10, o.steps); ++k) advance(s, m, control, stepping, {}, workspace);
    const double strain = s.strain, time = s.time, start = seconds(o.threads > 1);
    long iterations = 0, fallbacks = 0, steps = 0;
    double residual = 0;
    for (; steps < o.steps && s.strain < strain + o.strain; ++steps) {
        Evaluation e = advance(s, m, control, stepping, {strain + o.strain}, workspace);
        iterations += e.solve.iterations;
        fallbacks += e.solve.fell_back;
        residual = std::max(residual, e.solve.residual);
        recycle(std::move(e), workspace);
    }
    const double spent = seconds(o.threads > 1) - start;
    const double core_memory = resident_MB() - resident_before;
    rusage usage;  // before the sample
    getrusage(RUSAGE_SELF, &usage);
    // not evaluate_in_detail: its factor would not fit for 10^5 particles
    const Sample last = make_sample(s, evaluate_sample(s, m, control, workspace));
    const nlohmann::ordered_json line{
        {"solver", name},
        {"tolerance", o.tolerance},
        {"threads", o.threads},
        {"particles", s.size()},
        {"pairs", workspace.buffers().neighbours.candidates().size()},
        {"scheme", o.scheme},
        {"displacement", o.displacement},
        {"steps", steps},
        {"ms_per_step", 1e3 * spent / steps},
        {"ms_per_evaluation", 1e3 * spent / steps / (o.scheme == "heun" ? 2 : 1)},
        {"iterations", static_cast<double>(iterations) / steps},
        {"largest_residual", residual},
        {"fallbacks", fallbacks},
        {"strain", s.strain - strain},
        {"mean_shear_rate", (s.strain - strain) / (s.time - time)},
        {"seconds_per_strain", spent / (s.strain - strain)},
        {"contact_number", last.contact_number},
        {"sliding_fraction", last.sliding_fraction},
        {"smallest_xi", last.smallest_xi},
        {"core_memory_MB", core_memory},
        {"peak_memory_MB", static_cast<double>(usage.ru_maxrss) / 1024}};
    std::cout << line.dump() << std::endl;
}

}

int main(int argc, char** argv)
{
    Options o;
    CLI::App app("cost of whole steps");
    app.add_option("--particles", o.particles);
    app.add_option("--volume-fraction", o.volume_fraction);
    app.add_option("--stress", o.stress, "sigma0");
    app.add_option("--normal-stiffness", o.normal_stiffness, "F*/a; tangential: half of it");
    app.add_option("--debye-length", o.debye_length, "a");
    app.add_option("--pre-shear", o.pre_shear, "strain before the measurement");
    app.add_option("--state", o.state, "start from a state instead of a packing (case file)");
    app.add_option("--save", o.save, "write the pre-sheared state (case file)");
    app.add_option("--steps", o.steps, "at most");
    app.add_option("--strain", o.strain, "measured");
    app.add_option("--scheme", o.scheme, "heun, implicit");
    app.add_option("--displacement", o.displacement, "a");
    app.add_option("--solver", o.solvers, "pcg, cholesky, lagged_cholesky");
    app.add_option("--tolerance", o.tolerance);
    app.add_option("--threads", o.threads);
    CLI11_PARSE(app, argc, argv);
    try {
        const Model m = model_of(o);
        const State s = start_of(o, m);
        for (const std::string& solver : o.solvers) measure(o, m, s, solver);
    } catch (const Error& error) {
        std::fprintf(stderr, "bench_step: %s\n", error.what());
        return static_cast<int>(error.kind());
    }
}
