// engine/exponents.h -- growth and frequency of a short series without noise.
//
// Equally spaced values of A exp(x_1 t) + B exp(x_2 t) obey v_(k+2) = p v_(k+1) + q v_k, and exp(x
// spacing) are the roots of z^2 = p z + q (Prony 1795). Frequencies beyond pi/spacing are aliased.
//
// Tests: sums of two exponentials.
#pragma once
#include <array>
#include <complex>
#include <span>

namespace sigmaflow {

/// The two exponents x of a series amplitude(t) = A exp(x_1 t) + B exp(x_2 t) at equal spacing,
/// that with the larger real part first: least squares of its linear recurrence. Errors: input
/// (fewer than 4 values), numerics (a series that is none: all 0).
std::array<std::complex<double>, 2> exponents_of(std::span<const double> series, double spacing);

}
