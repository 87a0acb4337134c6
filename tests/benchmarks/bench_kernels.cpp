// bench_kernels -- cost of the parts of an evaluation, one thread, by Google Benchmark.
//
//   neighbours         all close pairs, as at every rebuild of the neighbour list
//   slices             the order of particles and pairs, at every rebuild too
//   locate             is the list still good; geometry and touching pairs
//   prepare            locate, forces, resistance matrix and loads
//   multiply           one product with the resistance matrix, in double precision
//   factor             the incomplete factor of pcg, and the true residual once
//   pcg                stress control from a zero guess, without the factor
//   cholesky           the same: factorisation and solution, without the symbolic analysis
//   lagged_cholesky    the same with the factor of one step earlier
//   evaluate_in_detail velocities and stress by one factorisation
//
// The argument is the number of particles. Counters: CPU time per particle, per candidate pair,
// and per candidate pair and iteration; iterations of a solve.
#include "engine/packing.h"
#include "engine/step.h"
#include "engine/workspace.h"

#include <benchmark/benchmark.h>
#include <algorithm>
#include <map>

namespace sigmaflow {

namespace {

using benchmark::Counter;

constexpr double stress = 2;
constexpr double pre_shear = 0.2;
constexpr double skin = 0.1;  // [a], about that of a run

Model model()
{
    Model m;
    m.stiffness_scale = StiffnessScale::fixed;
    m.normal_stiffness = 400;
    m.tangential_stiffness = 200;
    m.debye_length = 0.05;
    return m;
}

// A packing has no contacts, but they make most of the forces and of the ill-conditioning: it is
// sheared until there are about two a particle.
// Made once for each size.
const State& dense_state(int particles)
{
    static std::map<int, State> made;
    const auto [at, is_new] = made.try_emplace(particles);
    State& s = at->second;
    if (!is_new) return s;
    PackingParameters p;
    p.particles = particles;
    p.volume_fraction = 0.58;
    s = random_packing(p);
    Workspace workspace({SolverKind::pcg, 1e-3});
    while (s.strain < pre_shear)
        recycle(advance(s, model(), ImposedStress{stress}, {Scheme::implicit, 1e-2}, {pre_shear},
                        workspace),
                workspace);
    return s;
}

/// A prepared problem of stress control.
struct Prepared {
    const State& state;
    Workspace workspace;
    Workspace::Buffers& buffers = workspace.buffers();
    double weight = 0;

    Prepared(const State& s, const SolverSettings& settings = {}) : state(s), workspace(settings)
    {
        const Evaluation e = prepare(state, model(), ImposedStress{stress}, nullptr, buffers);
        const Loads loads = assemble_loads(state, e, buffers);
        weight = 1 / loads.affine;
        const double rate = weight * (stress * state.box.volume() - loads.first_moment);
        for (std::size_t k = 0; k < buffers.right.size(); ++k)
            for (int c = 0; c < 6; ++c)
                buffers.right[k].c[c] =
                    buffers.fixed_load[k].c[c] + rate * buffers.unit_load[k].c[c];
    }

    void prepare_again()
    {
        buffers.located = false;
        recycle(prepare(state, model(), ImposedStress{stress}, nullptr, buffers), workspace);
    }

    SolveReport solve(ResistanceSolver& solver)
    {
        buffers.solution.assign(buffers.right.size(), Slice6{});
        return solver.solve({buffers.matrix, &buffers.unit_load, weight}, buffers.right,
                            buffers.solution);
    }

    void set_pattern(ResistanceSolver& solver) const
    {
        solver.set_pattern(state.size(), buffers.neighbours.candidates());
    }
};

Counter time_per(double items)
{
    return {items, Counter::kIsIterationInvariantRate | Counter::kInvert};
}

void count(benchmark::State& run, const State& s, std::size_t pairs)
{
    run.counters["pairs"] = static_cast<double>(pairs);
    run.counters["per_particle"] = time_per(s.size());
    run.counters["per_pair"] = time_per(static_cast<double>(pairs));
}

void count(benchmark::State& run, const Prepared& p)
{
    count(run, p.state, p.buffers.neighbours.candidates().size());
    run.counters["contacts"] = 2. * static_cast<double>(p.buffers.touching.size()) / p.state.size();
}

void count(benchmark::State& run, const Prepared& p, const SolveReport& report)
{
    count(run, p);
    const double pairs = static_cast<double>(p.buffers.neighbours.candidates().size());
    run.counters["iterations"] = report.iterations;
    if (report.iterations > 0) run.counters["per_pair_it"] = time_per(pairs * report.iterations);
    if (report.fell_back) run.SkipWithError("no convergence: fell back to Cholesky");
}

void neighbours(benchmark::State& run)
{
    const State& s = dense_state(static_cast<int>(run.range(0)));
    PairSearch search;
    std::vector<Candidate> found;
    for (auto _ : run) close_pairs(s, interaction_range(model()), skin, 1, search, found);
    count(run, s, found.size());
}

void slices(benchmark::State& run)
{
    const State& s = dense_state(static_cast<int>(run.range(0)));
    const auto candidates = close_pairs(s, interaction_range(model()), skin);
    SliceMaker maker;
    Slices made;
    for (auto _ : run) maker.make(s, candidates, made);
    count(run, s, candidates.size());
}

void locate(benchmark::State& run)
{
    Prepared p(dense_state(static_cast<int>(run.range(0))));
    for (auto _ : run) {
        p.buffers.located = false;
        sigmaflow::locate(p.state, model(), p.buffers);
    }
    count(run, p);
}

void prepare(benchmark::State& run)
{
    Prepared p(dense_state(static_cast<int>(run.range(0))));
    for (auto _ : run) p.prepare_again();
    count(run, p);
}

void multiply(benchmark::State& run)
{
    Prepared p(dense_state(static_cast<int>(run.range(0))));
    SlicedVector product;
    for (auto _ : run) sigmaflow::multiply(p.buffers.matrix, p.buffers.right, product);
    count(run, p);
}

// With a tolerance of one a zero guess is good enough.
void factor(benchmark::State& run)
{
    Prepared p(dense_state(static_cast<int>(run.range(0))));
    ResistanceSolver solver({SolverKind::pcg, 1});
    for (auto _ : run) {
        run.PauseTiming();
        p.set_pattern(solver);  // forgets the factor
        run.ResumeTiming();
        p.solve(solver);
    }
    count(run, p);
}

// The factor serves up to ten solves; it is made while the clock stands.
void pcg(benchmark::State& run, double tolerance)
{
    Prepared p(dense_state(static_cast<int>(run.range(0))));
    ResistanceSolver solver({SolverKind::pcg, tolerance});
    SolveReport report;
    int solves = 0;
    for (auto _ : run) {
        if (solves++ % 8 == 0) {
            run.PauseTiming();
            p.set_pattern(solver);
            p.solve(solver);
            run.ResumeTiming();
        }
        report = p.solve(solver);
    }
    count(run, p, report);
}

void cholesky(benchmark::State& run)
{
    Prepared p(dense_state(static_cast<int>(run.range(0))));
    ResistanceSolver solver({SolverKind::cholesky});
    p.set_pattern(solver);
    p.solve(solver);  // analyses the pattern
    for (auto _ : run) p.solve(solver);
    count(run, p);
}

void lagged_cholesky(benchmark::State& run, double tolerance)
{
    Prepared before(dense_state(static_cast<int>(run.range(0))));
    State moved = before.state;
    advance(moved, model(), ImposedStress{stress}, {Scheme::heun, 1e-3}, {}, before.workspace);
    Prepared old(before.state), p(moved);
    ResistanceSolver solver({SolverKind::lagged_cholesky, tolerance});
    old.set_pattern(solver);
    old.solve(solver);
    SolveReport report;
    for (auto _ : run) report = p.solve(solver);
    count(run, p, report);
}

void evaluate_in_detail(benchmark::State& run)
{
    Prepared p(dense_state(static_cast<int>(run.range(0))));
    const auto evaluate_once = [&] {
        benchmark::DoNotOptimize(
            sigmaflow::evaluate_in_detail(p.state, model(), ImposedStress{stress}, p.workspace));
    };
    evaluate_once();  // analyses the pattern
    for (auto _ : run) evaluate_once();
    count(run, p);
}

void any_size(benchmark::internal::Benchmark* b)
{
    for (int n : {200, 500, 2000, 4500, 20000, 100000}) b->Arg(n);
    b->Unit(benchmark::kMicrosecond);
}

// the factor grows faster than n
void small_sizes(benchmark::internal::Benchmark* b)
{
    for (int n : {200, 500, 2000, 4500}) b->Arg(n);
    b->Unit(benchmark::kMicrosecond);
}

BENCHMARK(neighbours)->Apply(any_size);
BENCHMARK(slices)->Apply(any_size);
BENCHMARK(locate)->Apply(any_size);
BENCHMARK(prepare)->Apply(any_size);
BENCHMARK(multiply)->Apply(any_size);
BENCHMARK(factor)->Apply(any_size);
BENCHMARK_CAPTURE(pcg, 1e-4, 1e-4)->Apply(any_size);
BENCHMARK_CAPTURE(pcg, 1e-8, 1e-8)->Apply(any_size);
BENCHMARK(cholesky)->Apply(small_sizes);
BENCHMARK_CAPTURE(lagged_cholesky, 1e-4, 1e-4)->Apply(small_sizes);
BENCHMARK(evaluate_in_detail)->Apply(small_sizes);

}

}

BENCHMARK_MAIN();
