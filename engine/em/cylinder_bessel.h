// Cylinder functions of all orders 0, 1, ..., out.size() - 1 at one argument.
//
// Each is computed by recurrence in its stable direction: Hankel functions upwards, Bessel
// functions downwards (Miller). Relative errors are about 1e-13 times the argument's size in units
// of 100; orders far above the argument may overflow to infinity (argument 5: order 160).
//
// References:
//   [DLMF] NIST Digital Library of Mathematical Functions, chapter 10.
#pragma once

#include <span>

#include "engine/base/complex.h"

namespace rayloc {

// H_n^(2)(z) = J_n(z) - j Y_n(z): outgoing waves for the time factor exp(+j w t).
// REQUIRES: z > 0, out.size() >= 2.
void hankel_orders(double z, std::span<Complex<double>> out);

// J_n(z). REQUIRES: z > 0, out.size() >= 2.
void bessel_orders(double z, std::span<double> out);

// J_n(z) exp(-|Im z|), which does not overflow. REQUIRES: Im z <= 0, z != 0.
void scaled_bessel_orders(const Complex<double>& z, std::span<Complex<double>> out);

// J_n'(z) / J_n(z). REQUIRES: Im z <= 0, z != 0; no zero of J_n, so Im z < 0 or n > |z| suffices.
void log_derivative_orders(const Complex<double>& z, std::span<Complex<double>> out);

}  // namespace rayloc
