#include "engine/em/cylinder_window.h"

#include <cmath>
#include <numbers>

namespace rayloc {
namespace {

using C = Complex<double>;

// Below: the power series, which loses digits at larger u; above: the continued fraction, which
// converges slowly at smaller u.
constexpr double kSeriesEnd = 2.4;
constexpr double kMinWindowTerm = 1e-18;  // squared, of a term of the series

// With z^2 = j pi u^2 / 2 the knife edge is 1 - erfc(z) / 2.
C half_erf_series(const C& z) {
  const C z2 = z * z;
  C term = z;
  C sum;
  for (int n = 0; abs2(term) > kMinWindowTerm * kMinWindowTerm; ++n) {
    sum = sum + C{1.0 / (2.0 * n + 1.0), 0.0} * term;
    term = C{-1.0 / (n + 1.0), 0.0} * term * z2;
  }
  return C{std::numbers::inv_sqrtpi, 0.0} * sum;
}

C half_erfc_fraction(const C& z) {
  C tail = z;
  // Terms for 13 digits.
  for (int n = 8 + static_cast<int>(500.0 / abs2(z)); n > 0; --n) {
    tail = z + C{0.5 * n, 0.0} / tail;
  }
  const C z2 = z * z;
  return C{0.5 * std::numbers::inv_sqrtpi, 0.0} * exp(C{-z2.re, -z2.im}) / tail;
}

}  // namespace

Complex<double> knife_edge(double u) {
  const double size = std::abs(u);
  const double part = size * std::sqrt(std::numbers::pi) / 2.0;
  const C z{part, part};  // squared: j pi u^2 / 2
  // Contribution of the part beyond |u|.
  const C beyond = size < kSeriesEnd ? C{0.5, 0.0} - half_erf_series(z) : half_erfc_fraction(z);
  return u < 0.0 ? beyond : C{1.0, 0.0} - beyond;
}

Complex<double> knife_edge_slope(double u) {
  const double phase = -std::numbers::pi / 2.0 * u * u;
  return C{0.5, 0.5} * C{std::cos(phase), std::sin(phase)};
}

}  // namespace rayloc
