#include "engine/solver.h"

#include "engine/cholesky.h"
#include "engine/error.h"
#include "engine/pcg.h"

#include <cmath>

namespace sigmaflow {

namespace {

constexpr int precise_solves = 50;
constexpr int aged = 8;               // iterations from which a new factor is cheaper
constexpr int most_iterations = 200;  // with an old factor

// v += s w
void add(SlicedVector& v, double s, const SlicedVector& w)
{
    for (std::size_t k = 0; k < v.size(); ++k)
        for (int c = 0; c < 6; ++c) v[k].c[c] += s * w[k].c[c];
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
    void find_residual(const ResistanceProblem& problem, const SlicedVector& b,
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
    add(x, problem.weight * dot(f, x) / (1 - problem.weight * dot(f, direction)), direction);
}

// residual = b - (R - w f f^T) x
void ResistanceSolver::Impl::find_residual(const ResistanceProblem& problem, const SlicedVector& b,
                                           const SlicedVector& x)
{
    multiply(problem.matrix, x, product);
    residual = b;
    add(residual, -1, product);
    if (problem.direction)
        add(residual, problem.weight * dot(*problem.direction, x), *problem.direction);
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
    const double tolerance = share * s.settings.tolerance;
    if (x.size() != b.size()) x.assign(b.size(), Slice6{});
    SolveReport report;
    if (s.settings.kind == SolverKind::pcg) {
        if (s.iterate(problem, b, tolerance, x, report)) return report;
        report.fell_back = true;
    }
    if (s.settings.kind == SolverKind::lagged_cholesky) {
        if (!s.factorised) s.factorise(problem.matrix);
        const bool good = s.iterate_with_factor(problem, b, tolerance, x, report);
        if (report.iterations > aged) s.factorised = false;
        if (good) {
            s.find_residual(problem, b, x);
            const double b2 = dot(b, b);
            report.residual = b2 > 0 ? std::sqrt(dot(s.residual, s.residual) / b2) : 0;
            return report;
        }
        report.fell_back = true;
    }
    s.factorise(problem.matrix);
    s.solve_with_factor(problem, b, x);
    s.find_residual(problem, b, x);
    const double b2 = dot(b, b);
    report.residual = b2 > 0 ? std::sqrt(dot(s.residual, s.residual) / b2) : 0;
    return report;
}

void ResistanceSolver::solve_directly(const ResistanceMatrix& matrix,
                                      const std::vector<const Velocities*>& b,
                                      const std::vector<Velocities*>& x)
{
    impl_->factorise(matrix);
    impl_->cholesky.solve(b, x);
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
}

std::string solver_version()
{
    return cholesky_version();
}

}
