#include "engine/solver.h"

#include "engine/cholesky.h"
#include "engine/pcg.h"

#include <cmath>
#include <optional>

namespace sigmaflow {

struct ResistanceSolver::Impl {
    SolverSettings settings;
    ConjugateGradients gradients;
    Cholesky cholesky;
    bool analysed = false;  // the pattern of the Cholesky factor is made when it is first needed
    int particles = 0;
    std::vector<Candidate> candidates;
    Velocities scratch;

    void factorise(const ResistanceMatrix& matrix)
    {
        if (!analysed) cholesky.set_pattern(particles, candidates);
        analysed = true;
        cholesky.factorise(matrix);
    }

    void solve_with_factor(const ResistanceProblem& problem, const Velocities& b, Velocities& x);
    double residual(const ResistanceProblem& problem, const Velocities& b, const Velocities& x);
};

// x = R^-1 b + s R^-1 f with s = w f.R^-1 b/(1 - w f.R^-1 f)   (Sherman & Morrison 1950)
void ResistanceSolver::Impl::solve_with_factor(const ResistanceProblem& problem,
                                               const Velocities& b, Velocities& x)
{
    if (!problem.direction) {
        cholesky.solve({&b}, {&x});
        return;
    }
    const Velocities& f = *problem.direction;
    cholesky.solve({&b, &f}, {&x, &scratch});
    const double s = problem.weight * dot(f, x) / (1 - problem.weight * dot(f, scratch));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += s * scratch[i];
}

double ResistanceSolver::Impl::residual(const ResistanceProblem& problem, const Velocities& b,
                                        const Velocities& x)
{
    multiply(problem.matrix, x, scratch);
    const double s = problem.direction ? problem.weight * dot(*problem.direction, x) : 0;
    double square = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        Vec6 r = b[i] - scratch[i];
        if (problem.direction) r += s * (*problem.direction)[i];
        square += r.squaredNorm();
    }
    const double size = dot(b, b);
    return size > 0 ? std::sqrt(square / size) : 0;
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
    impl_->particles = n;
    impl_->candidates = candidates;
    impl_->analysed = false;
    impl_->gradients.forget();
}

SolveReport ResistanceSolver::solve(const ResistanceProblem& problem, const Velocities& b,
                                    Velocities& x)
{
    Impl& s = *impl_;
    if (x.size() != b.size()) x.assign(b.size(), Vec6::Zero());
    SolveReport report;
    if (s.settings.kind == SolverKind::pcg) {
        if (s.gradients.solve(problem, b, x, s.settings.tolerance, report)) return report;
        report.fell_back = true;
    }
    s.factorise(problem.matrix);
    s.solve_with_factor(problem, b, x);
    report.residual = s.residual(problem, b, x);
    return report;
}

void ResistanceSolver::solve_directly(const ResistanceMatrix& matrix,
                                      const std::vector<const Velocities*>& b,
                                      const std::vector<Velocities*>& x)
{
    impl_->factorise(matrix);
    impl_->cholesky.solve(b, x);
}

std::string solver_version()
{
    return cholesky_version();
}

}
