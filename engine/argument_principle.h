// engine/argument_principle.h -- how many zeros a function has in the right half of the complex
// plane.
//
// For f without poles at Re x >= 0, the number of zeros inside a closed curve is the number of
// times f runs around 0 along it (Cauchy's argument principle). The curve is the half circle of a
// radius beyond all zeros, closed by the imaginary axis; with f(conj x) = conj f(x) its upper half
// is enough. A piece is halved until f turns by less than half a radian on both of its halves.
//
// Tests: polynomials of known zeros, delays against Hayes' criterion.
#pragma once
#include <complex>
#include <functional>

namespace sigmaflow {

/// f real on the real axis and not 0 at 0. Errors: input (radius <= 0), numerics (a zero on the
/// curve, or too close to it).
int zeros_in_right_half_plane(const std::function<std::complex<double>(std::complex<double>)>& f,
                              double radius);

}
