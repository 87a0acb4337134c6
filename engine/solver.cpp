#include "engine/solver.h"

#include "engine/checks.h"
#include "engine/cholesky.h"
#include "engine/error.h"
#include "engine/pcg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace sigmaflow {

namespace {

constexpr int precise_solves = 50;
constexpr int aged = 8;               // iterations from which a new factor is cheaper
constexpr int most_iterations = 200;  // with an old factor
constexpr double largest = 1e100;     // of what has finite squares

// v += s w
void add(SlicedVector& v, double s, const SlicedVector& w)
{
    for (std::size_t k = 0; k < v.size(); ++k)
        for (int c = 0; c < 6; ++c) v[k].c[c] += s * w[k].c[c];
}

// Numbers of which the squares are finite, too.
bool is_usable(const SlicedVector& v)
{
    return v.empty() || all_within(reinterpret_cast<const double*>(v.data()),
                                   v.size() * sizeof(Slice6) / sizeof(double), largest);
}

void check_right_hand_side(const SlicedVector& b, const Slices& slices)
{
    if (is_usable(b)) return;
    Velocities load;
    from_slices(b, slices, load);
    int i = 0;
    while (i + 1 < slices.particles && all_within(load[i].data(), 6, largest)) ++i;
    throw Error(ErrorKind::numerics, "",
                "the right-hand side of particle " + std::to_string(i) + " is not finite");
}

void check_direct_residual(double residual)
{
    if (residual <= largest_direct_residual) return;
    char text[128];
    std::snprintf(text, sizeof text,
                  "the direct solution of the resistance problem has a relative residual of %.3g, "
                  "the limit is %.3g",
                  std::abs(residual), largest_direct_residual);
    throw Error(ErrorKind::numerics, "", text);
}

}

struct ResistanceSolver::Impl {
    SolverSettings settings;
    ConjugateGradients<f8> gradients;
    ConjugateGradients<d8> precise_gradients;  // where single precision does not suffice
    Cholesky cholesky;
    int precise_left = 0;     // solves in double precision before single is tried again
    bool analysed = false;    // the pattern of the Cholesky factor is made when it is first needed
    bool factorised = false;  // there is a factor for as many particles, of this or an earlier R
    int particles = 0;
    std::vector<Candidate> candidates;
    SlicedVector residual, product, direction, search;
    Velocities right, other_right, solution, other_solution;

    void factorise(const ResistanceMatrix& matrix)
    {
        if (!analysed) cholesky.set_pattern(particles, candidates);
        analysed = true;
        cholesky.factorise(matrix);
        factorised = true;
    }

    bool iterate(const ResistanceProblem& problem, const SlicedVector& b, double tolerance,
                 SlicedVector& x, SolveReport& report)
    {
        const auto with = [&](auto& method) {
            SolveReport one;
            const bool good = method.solve(problem, b, x, tolerance, settings.threads, one);
            report.iterations += one.iterations;
            report.residual = one.residual;
            return good;
        };
        if (precise_left > 0)
            --precise_left;
        else if (with(gradients))
            return true;
        else
            precise_left = precise_solves;
        return with(precise_gradients);
    }

    void apply_factor(const Slices& slices, const SlicedVector& b, SlicedVector& x)
    {
        from_slices(b, slices, right);
        cholesky.solve({&right}, {&solution});
        to_slices(solution, slices, x);
    }

    void solve_with_factor(const ResistanceProblem& problem, const SlicedVector& b,
                           SlicedVector& x);
    double find_residual(const ResistanceProblem& problem, const SlicedVector& b,
                         const SlicedVector& x);
    bool iterate_with_factor(const ResistanceProblem& problem, const SlicedVector& b,
                             double tolerance, SlicedVector& x, SolveReport& report);

    template <class Archive>
    void archive(Archive& a)
    {
        a(precise_left, gradients, precise_gradients);
        if (settings.kind != SolverKind::lagged_cholesky) return;  // others make their factor anew
        a(factorised);
        if (factorised) a(analysed, cholesky);
    }
};

// x = R^-1 b + s R^-1 f with s = w f.R^-1 b/(1 - w f.R^-1 f)   (Sherman & Morrison 1950)
void ResistanceSolver::Impl::solve_with_factor(const ResistanceProblem& problem,
                                               const SlicedVector& b, SlicedVector& x)
{
    const Slices& slices = *problem.matrix.slices;
    if (!problem.direction) {
        apply_factor(slices, b, x);
        return;
    }
    const SlicedVector& f = *problem.direction;
    from_slices(b, slices, right);
    from_slices(f, slices, other_right);
    cholesky.solve({&right, &other_right}, {&solution, &other_solution});
    to_slices(solution, slices, x);
    to_slices(other_solution, slices, direction);
    const double left = 1 - problem.weight * dot(f, direction);
    if (!(left > 0))
        throw Error(ErrorKind::numerics, "",
                    "resistance matrix is not positive definite under an imposed stress");
    add(x, problem.weight * dot(f, x) / left, direction);
}

// residual = b - (R - w f f^T) x; returns |residual|/|b|
double ResistanceSolver::Impl::find_residual(const ResistanceProblem& problem,
                                             const SlicedVector& b, const SlicedVector& x)
{
    multiply(problem.matrix, x, product);
    residual = b;
    add(residual, -1, product);
    if (problem.direction)
        add(residual, problem.weight * dot(*problem.direction, x), *problem.direction);
    const double r2 = dot(residual, residual), b2 = dot(b, b);
    if (b2 == 0) return r2 == 0 ? 0 : std::numeric_limits<double>::infinity();
    return std::sqrt(r2 / b2);
}

bool ResistanceSolver::Impl::iterate_with_factor(const ResistanceProblem& problem,
                                                 const SlicedVector& b, double tolerance,
                                                 SlicedVector& x, SolveReport& report)
{
    const Slices& slices = *problem.matrix.slices;
    const SlicedVector* f = problem.direction;
    // the factor knows nothing of the rank-one term: Sherman & Morrison again, where it keeps the
    // preconditioner positive
    double weight = 0;
    if (f) {
        apply_factor(slices, *f, direction);
        const double left = 1 - problem.weight * dot(*f, direction);
        if (left > 0) weight = problem.weight / left;
    }
    SlicedVector z;
    const auto precondition = [&](const SlicedVector& r) {
        apply_factor(slices, r, z);
        if (weight != 0) add(z, weight * dot(direction, r), direction);
    };
    precondition(b);
    const double goal = tolerance * tolerance * dot(b, z);
    find_residual(problem, b, x);
    precondition(residual);
    double rho = dot(residual, z);
    search = z;
    while (rho > goal) {
        if (report.iterations == most_iterations || !std::isfinite(rho)) return false;
        multiply(problem.matrix, search, product);
        if (f) add(product, -problem.weight * dot(*f, search), *f);
        const double curvature = dot(search, product);
        if (!(curvature > 0)) return false;
        add(x, rho / curvature, search);
        add(residual, -rho / curvature, product);
        precondition(residual);
        const double next = dot(residual, z);
        for (std::size_t k = 0; k < search.size(); ++k)
            for (int c = 0; c < 6; ++c) search[k].c[c] = z[k].c[c] + next / rho * search[k].c[c];
        rho = next;
        ++report.iterations;
    }
    return std::isfinite(rho);
}

ResistanceSolver::ResistanceSolver(const SolverSettings& settings) : impl_(std::make_unique<Impl>())
{
    impl_->settings = settings;
}
ResistanceSolver::~ResistanceSolver() = default;
ResistanceSolver::ResistanceSolver(ResistanceSolver&&) noexcept = default;
ResistanceSolver& ResistanceSolver::operator=(ResistanceSolver&&) noexcept = default;

void ResistanceSolver::set_pattern(int n, const std::vector<Candidate>& candidates)
{
    if (impl_->particles != n) impl_->factorised = false;
    impl_->particles = n;
    impl_->candidates = candidates;
    impl_->analysed = false;
    impl_->gradients.forget();
    impl_->precise_gradients.forget();
}

SolveReport ResistanceSolver::solve(const ResistanceProblem& problem, const SlicedVector& b,
                                    SlicedVector& x, double share)
{
    Impl& s = *impl_;
    check_right_hand_side(b, *problem.matrix.slices);
    if (x.size() != b.size() || !is_usable(x)) x.assign(b.size(), Slice6{});
    const double tolerance = share * s.settings.tolerance;
    const double limit = std::min(largest_excess * tolerance, 1.);
    SolveReport report;
    if (s.settings.kind == SolverKind::pcg) {
        if (s.iterate(problem, b, tolerance, x, report) && report.residual <= limit) return report;
        report.fell_back = true;
    }
    if (s.settings.kind == SolverKind::lagged_cholesky) {
        if (!s.factorised) s.factorise(problem.matrix);
        const bool good = s.iterate_with_factor(problem, b, tolerance, x, report);
        if (report.iterations > aged) s.factorised = false;
        report.residual = s.find_residual(problem, b, x);
        if (good && report.residual <= limit) return report;
        report.fell_back = true;
    }
    s.factorise(problem.matrix);
    s.solve_with_factor(problem, b, x);
    report.residual = s.find_residual(problem, b, x);
    check_direct_residual(report.residual);
    return report;
}

SolveReport ResistanceSolver::solve_directly(const ResistanceMatrix& matrix,
                                             const std::vector<const Velocities*>& b,
                                             const std::vector<Velocities*>& x)
{
    Impl& s = *impl_;
    const Slices& slices = *matrix.slices;
    for (const Velocities* one : b) {
        to_slices(*one, slices, s.direction);
        check_right_hand_side(s.direction, slices);
    }
    s.factorise(matrix);
    s.cholesky.solve(b, x);
    SolveReport report;
    for (std::size_t k = 0; k < b.size(); ++k) {
        to_slices(*b[k], slices, s.direction);
        to_slices(*x[k], slices, s.search);
        const double residual = s.find_residual({matrix}, s.direction, s.search);
        check_direct_residual(residual);
        report.residual = std::max(report.residual, residual);
    }
    return report;
}

void ResistanceSolver::save(ArchiveWriter& archive)
{
    impl_->archive(archive);
}

void ResistanceSolver::restore(ArchiveReader& archive)
{
    Impl& s = *impl_;
    s.archive(archive);
    if (s.precise_left < 0 || s.precise_left > precise_solves)
        throw Error(ErrorKind::input, "", "has a solver that does not exist");
    if (s.factorised && s.cholesky.particles() != s.particles)
        throw Error(ErrorKind::input, "", "has a factor of another number of particles");
    if (s.factorised && s.analysed && !s.cholesky.has_pattern(s.candidates))
        throw Error(ErrorKind::input, "", "has a factor of other pairs");
}

std::string solver_version()
{
    return cholesky_version();
}

}
