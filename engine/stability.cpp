#include "engine/stability.h"

#include "engine/argument_principle.h"
#include "engine/error.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <unsupported/Eigen/Polynomials>

namespace sigmaflow {

namespace {

void require(bool good, const std::string& problem)
{
    if (!good) throw Error(ErrorKind::input, "stability", problem);
}

void check(const UniformFlow& flow)
{
    require(flow.viscosity.mean > 0 && std::isfinite(flow.viscosity.mean),
            "viscosity must be > 0 [eta0], got " + std::to_string(flow.viscosity.mean));
    require(flow.relaxation.mean > 0 && std::isfinite(flow.relaxation.mean),
            "relaxation must be > 0, got " + std::to_string(flow.relaxation.mean));
    require(std::isfinite(flow.slope.mean), "slope must be finite");
}

void check_place(double reynolds, int mode)
{
    require(reynolds > 0 && std::isfinite(reynolds), "Re must be > 0");
    require(mode >= 1, "mode must be >= 1");
}

double damping(double reynolds, int mode)
{
    return std::pow(mode * std::numbers::pi, 2) / reynolds;
}

double relative_error(const Value& value)
{
    return value.standard_error / value.mean;
}

using Complex = std::complex<double>;

/// b, B_i and c_i of the flow.
struct Response {
    double slow = 0;
    Eigen::ArrayXd parts, c;

    double sudden() const { return slow + parts.sum(); }
    Complex operator()(Complex x) const
    {
        return slow + (parts.cast<Complex>() * (x / (c.cast<Complex>() + x))).sum();
    }
};

Response response(const MemoryFlow& flow)
{
    check(UniformFlow{flow.viscosity, flow.slope, {1, 0}});
    check(flow.kernel);
    const auto terms = static_cast<Eigen::Index>(flow.kernel.terms.size());
    Response r{.slow = flow.viscosity.mean * flow.slope.mean,
               .parts = Eigen::ArrayXd(terms),
               .c = Eigen::ArrayXd(terms)};
    for (Eigen::Index i = 0; i < terms; ++i) {
        const MemoryTerm& term = flow.kernel.terms[static_cast<std::size_t>(i)];
        r.parts[i] = (1 - r.slow) * term.weight.mean;
        r.c[i] = term.c.mean;
    }
    if (const auto& viscosity = flow.instantaneous_viscosity) {
        const double sum = r.parts.sum();
        require(*viscosity > 0 && std::isfinite(*viscosity) && sum != 0,
                "instantaneous viscosity must be > 0 [eta0], got " + std::to_string(*viscosity));
        r.parts *= (flow.viscosity.mean / *viscosity - r.slow) / sum;
    }
    require(r.sudden() > 0,
            "the kernel answers a sudden stress by a viscosity that is not positive");
    return r;
}

using Polynomial = Eigen::VectorXd;  // coefficients of rising powers

Polynomial product(const Polynomial& a, const Polynomial& b)
{
    Polynomial result = Polynomial::Zero(a.size() + b.size() - 1);
    for (Eigen::Index i = 0; i < a.size(); ++i) result.segment(i, b.size()) += a[i] * b;
    return result;
}

/// prod_(j != without) (variable + zero_j)
Polynomial with_zeros(const Eigen::ArrayXd& zeros, Eigen::Index without = -1)
{
    Polynomial result = Polynomial::Ones(1);
    for (Eigen::Index j = 0; j < zeros.size(); ++j)
        if (j != without) result = product(result, Eigen::Vector2d(zeros[j], 1));
    return result;
}

/// (slow + sum_i parts_i v/(v + zero_i)) prod (v + zero_i)
Polynomial numerator(const Response& r, const Eigen::ArrayXd& zeros)
{
    Polynomial result = r.slow * with_zeros(zeros);
    for (Eigen::Index i = 0; i < zeros.size(); ++i)
        result.tail(zeros.size()) += r.parts[i] * with_zeros(zeros, i);
    return result;
}

std::vector<Complex> roots(const Polynomial& polynomial)
{
    const Eigen::PolynomialSolver<double, Eigen::Dynamic> solver(polynomial);
    return {solver.roots().begin(), solver.roots().end()};
}

/// D and frequency of the onset.
struct Crossing {
    double damping = 0, frequency = 0;
};

std::optional<Crossing> crossing(const MemoryFlow& flow)
{
    const Response r = response(flow);
    const Eigen::ArrayXd squares = r.c.square();
    std::optional<Crossing> first;
    for (const Complex& z : roots(numerator(r, squares))) {
        constexpr double rounding = 1e-7;  // of a root that is real
        if (!(z.real() > 0) || std::abs(z.imag()) > rounding * z.real()) continue;
        const double d = (r.parts * r.c * z.real() / (z.real() + squares)).sum();
        if (d > 0 && (!first || d > first->damping)) first = {d, std::sqrt(z.real())};
    }
    return first;
}

/// What the error of a number adds to the relative error of D, `at` being the flow with another
/// value of this number.
template <class FlowAt>
double share_of_error(const Value& value, double at_onset, FlowAt at)
{
    if (!(value.standard_error > 0)) return 0;
    const double step = 1e-4 * (value.mean != 0 ? std::abs(value.mean) : value.standard_error);
    const auto up = crossing(at(value.mean + step)), down = crossing(at(value.mean - step));
    if (!up || !down) return 0;
    return (up->damping - down->damping) / (2 * step) * value.standard_error / at_onset;
}

double relative_error(const MemoryFlow& flow, double at_onset)
{
    double squares = 0;
    const auto add = [&](const Value& value, const auto& change) {
        const auto at = [&](double to) {
            MemoryFlow there = flow;
            change(there, to);
            return there;
        };
        squares += std::pow(share_of_error(value, at_onset, at), 2);
    };
    add(flow.viscosity, [](MemoryFlow& there, double to) { there.viscosity.mean = to; });
    add(flow.slope, [](MemoryFlow& there, double to) { there.slope.mean = to; });
    for (std::size_t i = 0; i < flow.kernel.terms.size(); ++i) {
        const MemoryTerm& term = flow.kernel.terms[i];
        add(term.c, [i](MemoryFlow& there, double to) { there.kernel.terms[i].c.mean = to; });
        add(term.weight, [i](MemoryFlow& there, double to) {
            auto& terms = there.kernel.terms;
            const double sum = 1 - there.kernel.instantaneous;
            const double others = sum + to - terms[i].weight.mean;
            terms[i].weight.mean = to;
            for (MemoryTerm& one : terms) one.weight.mean *= sum / others;
        });
    }
    return std::sqrt(squares);
}

}

std::optional<Onset> onset_of_instability(const UniformFlow& flow)
{
    check(flow);
    if (flow.slope.mean >= 0) return std::nullopt;
    const double c = flow.relaxation.mean;
    const double critical =
        -std::numbers::pi * std::numbers::pi / (c * flow.viscosity.mean * flow.slope.mean);
    const double error = std::hypot(relative_error(flow.viscosity), relative_error(flow.slope),
                                    relative_error(flow.relaxation));
    return Onset{.reynolds = {critical, critical * error},
                 .frequency = std::numbers::pi * std::sqrt(c / critical)};
}

std::array<std::complex<double>, 2> growth_rates(const UniformFlow& flow, double reynolds, int mode)
{
    check(flow);
    check_place(reynolds, mode);
    const double c = flow.relaxation.mean;
    const double half = (damping(reynolds, mode) + c * flow.viscosity.mean * flow.slope.mean) / 2;
    const double product = c * damping(reynolds, mode);
    if (half * half < product) {
        const double imaginary = std::sqrt(product - half * half);
        return {std::complex(-half, imaginary), std::complex(-half, -imaginary)};
    }
    // the root of larger size has no cancellation, the other one follows from the product
    const double large = -half - std::copysign(std::sqrt(half * half - product), half);
    const double small = product / large;
    return {std::max(large, small), std::min(large, small)};
}

double instantaneous_viscosity(const MemoryFlow& flow)
{
    return flow.viscosity.mean / response(flow).sudden();
}

Complex dispersion(const MemoryFlow& flow, double reynolds, int mode, Complex x)
{
    check_place(reynolds, mode);
    return damping(reynolds, mode) + x * response(flow)(x);
}

std::vector<Complex> growth_rates(const MemoryFlow& flow, double reynolds, int mode)
{
    check_place(reynolds, mode);
    const Response r = response(flow);
    Polynomial polynomial = Polynomial::Zero(r.c.size() + 2);
    polynomial.tail(r.c.size() + 1) = numerator(r, r.c);
    polynomial.head(r.c.size() + 1) += damping(reynolds, mode) * with_zeros(r.c);
    std::vector<Complex> result = roots(polynomial);
    std::sort(result.begin(), result.end(), [](const Complex& a, const Complex& b) {
        return a.real() != b.real() ? a.real() > b.real() : a.imag() > b.imag();
    });
    return result;
}

int growing_roots(const MemoryFlow& flow, double reynolds, int mode)
{
    const std::vector<Complex> all = growth_rates(flow, reynolds, mode);
    return static_cast<int>(
        std::count_if(all.begin(), all.end(), [](const Complex& x) { return x.real() > 0; }));
}

double growth_at_imposed_rate(const MemoryFlow& flow)
{
    const Response r = response(flow);
    const std::vector<Complex> zeros = roots(numerator(r, r.c));
    const auto largest =
        std::max_element(zeros.begin(), zeros.end(),
                         [](const Complex& a, const Complex& b) { return a.real() < b.real(); });
    return largest->real();
}

int unstable_roots(const MemoryFlow& flow, double reynolds, int mode)
{
    check_place(reynolds, mode);
    const Response r = response(flow);
    const double d = damping(reynolds, mode);
    // |x + c| >= |x| at Re x >= 0, so that beyond this radius |x| h is larger than the rest of F
    const double radius = 2 * (d + (r.parts * r.c).abs().sum()) / r.sudden();
    return zeros_in_right_half_plane([&](Complex x) { return d + x * r(x); }, radius);
}

std::optional<Onset> onset_of_instability(const MemoryFlow& flow)
{
    const auto onset = crossing(flow);
    if (!onset) return std::nullopt;
    const double reynolds = std::pow(std::numbers::pi, 2) / onset->damping;
    return Onset{.reynolds = {reynolds, reynolds * relative_error(flow, onset->damping)},
                 .frequency = onset->frequency};
}

std::optional<double> reynolds_of_growth(const MemoryFlow& flow, double growth)
{
    require(growth >= 0 && std::isfinite(growth), "growth must be >= 0");
    const Response r = response(flow);
    const double bound = (r.parts.max(0) * r.c).sum();  // D of no onset is larger
    if (!(bound > 0)) return std::nullopt;
    const auto grows = [&](double reynolds) {
        return growth_rates(flow, reynolds)[0].real() >= growth;
    };
    double low = 0.999 * std::pow(std::numbers::pi, 2) / bound, high = low;
    constexpr double step = 1.1;
    const double highest = 1e12 * low;
    while (!grows(high)) {
        low = high;
        high *= step;
        if (high > highest) return std::nullopt;
    }
    for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (grows(middle) ? high : low) = middle;
    }
    return (low + high) / 2;
}

}
