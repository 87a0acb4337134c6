#include "engine/argument_principle.h"

#include "engine/error.h"

#include <cmath>
#include <numbers>

namespace sigmaflow {

namespace {

using Complex = std::complex<double>;
using Function = std::function<Complex(Complex)>;
using Curve = std::function<Complex(double)>;

struct Point {
    double parameter;
    Complex value;
};

/// How far f turns around 0 along the curve from a to b.
double turn(const Function& f, const Curve& curve, const Point& a, const Point& b, int depth)
{
    const double middle = (a.parameter + b.parameter) / 2;
    const Point m{middle, f(curve(middle))};
    const double first = std::arg(m.value / a.value), second = std::arg(b.value / m.value);
    constexpr double small = 0.5;
    if (std::abs(first) < small && std::abs(second) < small) return first + second;
    if (depth == 0)  // also for what is not finite
        throw Error(ErrorKind::numerics, "argument principle", "a zero is too close to the curve");
    return turn(f, curve, a, m, depth - 1) + turn(f, curve, m, b, depth - 1);
}

double turn(const Function& f, const Curve& curve, double from, double to, int pieces)
{
    constexpr int deepest = 40;
    double sum = 0;
    Point a{from, f(curve(from))};
    for (int k = 1; k <= pieces; ++k) {
        const double parameter = from + (to - from) * k / pieces;
        const Point b{parameter, f(curve(parameter))};
        sum += turn(f, curve, a, b, deepest);
        a = b;
    }
    return sum;
}

}

int zeros_in_right_half_plane(const Function& f, double radius)
{
    if (!(radius > 0) || !std::isfinite(radius))
        throw Error(ErrorKind::input, "argument principle", "needs a radius > 0");
    const auto arc = [&](double angle) { return std::polar(radius, angle); };
    // frequencies of very different size may matter: equal steps of the logarithm
    constexpr double decades = 16;
    const auto axis = [&](double p) { return Complex(0, radius * std::pow(10., -decades * p)); };
    const double lowest = radius * std::pow(10., -decades);
    const auto end = [&](double p) { return Complex(0, lowest * (1 - p)); };
    constexpr int pieces = 64;
    const double turned = turn(f, arc, 0, std::numbers::pi / 2, pieces) +
                          turn(f, axis, 0, 1, 4 * pieces) + turn(f, end, 0, 1, 2);
    return static_cast<int>(std::lround(turned / std::numbers::pi));
}

}
