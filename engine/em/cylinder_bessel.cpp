#include "engine/em/cylinder_bessel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Above this argument the downward recurrence is long and not needed, as only conductors reach it.
constexpr double kConductor = 4000.0;
// A downward recurrence is scaled down before the squares of its numbers overflow.
constexpr double kLarge = 1e100;

// A starting order from which the downward recurrence forgets its wrong start before the requested
// orders: J_n(z) falls by more than 1e-16 between max(n, |z|) and it.
std::size_t starting_order(double size, std::size_t orders) {
  const double from = std::max(size, static_cast<double>(orders));
  return static_cast<std::size_t>(from + 8.0 * std::cbrt(from) + 18.0);
}

// [DLMF] 10.19(ii) in the logarithmic derivative: the wave that grows outwards in a conductor.
Complex<double> conductor_log_derivative(const Complex<double>& z, double n) {
  const Complex<double> one{1.0, 0.0};
  const Complex<double> nz = Complex<double>{n, 0.0} / z;
  const Complex<double> cos2 = one - nz * nz;
  return Complex<double>{0.0, 1.0} * sqrt(cos2) - Complex<double>{0.5, 0.0} / (z * cos2);
}

}  // namespace

void hankel_orders(double z, std::span<Complex<double>> out) {
  RAYLOC_CHECK(out.size() >= 2);
  out[0] = {::j0(z), -::y0(z)};
  out[1] = {::j1(z), -::y1(z)};
  const double twice_over_z = 2.0 / z;
  for (std::size_t n = 1; n + 1 < out.size(); ++n) {
    const double factor = twice_over_z * static_cast<double>(n);
    out[n + 1] = {factor * out[n].re - out[n - 1].re, factor * out[n].im - out[n - 1].im};
  }
}

void bessel_orders(double z, std::span<double> out) {
  RAYLOC_CHECK(out.size() >= 2);
  double above = 0.0;
  double here = 1.0 / kLarge;
  for (std::size_t n = starting_order(z, out.size()); n > 0; --n) {
    // `here` is J_n up to a common factor.
    const double below = (2.0 * static_cast<double>(n) / z) * here - above;
    above = here;
    here = below;
    if (n - 1 < out.size()) {
      out[n - 1] = here;
    }
    if (std::abs(here) > kLarge) {
      above /= kLarge;
      here /= kLarge;
      for (std::size_t i = n - 1; i < out.size(); ++i) {
        out[i] /= kLarge;
      }
    }
  }
  // Near a zero of J_0 its neighbour determines the factor.
  const double factor = std::abs(out[0]) > std::abs(out[1]) ? ::j0(z) / out[0] : ::j1(z) / out[1];
  for (double& value : out) {
    value *= factor;
  }
}

void scaled_bessel_orders(const Complex<double>& z, std::span<Complex<double>> out) {
  RAYLOC_CHECK(z.im <= 0.0);
  // [DLMF] 10.12.4 with t = j: J_0 + 2 sum j^n J_n = exp(j z), the larger of exp(+-j z).
  Complex<double> sum;
  Complex<double> above;
  Complex<double> here{1.0 / kLarge, 0.0};
  const Complex<double> one_over_z = Complex<double>{1.0, 0.0} / z;
  for (std::size_t n = starting_order(std::sqrt(abs2(z)), out.size()); n > 0; --n) {
    const double twice = 2.0 * static_cast<double>(n);
    const Complex<double> below =
        Complex<double>{twice * one_over_z.re, twice * one_over_z.im} * here - above;
    above = here;
    here = below;
    if (n - 1 < out.size()) {
      out[n - 1] = here;
    }
    // Horner's scheme over the orders: J_0 + 2 j (J_1 + j (J_2 + ...)).
    sum = Complex<double>{-sum.im, sum.re} + here;
    if (n == 1) {
      sum = sum + sum - here;
    }
    if (std::abs(here.re) + std::abs(here.im) > kLarge) {
      const Complex<double> scale{1.0 / kLarge, 0.0};
      above = scale * above;
      here = scale * here;
      sum = scale * sum;
      for (std::size_t i = n - 1; i < out.size(); ++i) {
        out[i] = scale * out[i];
      }
    }
  }
  const Complex<double> factor = Complex<double>{std::cos(z.re), std::sin(z.re)} / sum;
  for (Complex<double>& value : out) {
    value = factor * value;
  }
}

void log_derivative_orders(const Complex<double>& z, std::span<Complex<double>> out) {
  RAYLOC_CHECK(z.im <= 0.0);
  const double size = std::sqrt(abs2(z));
  if (size > kConductor) {
    for (std::size_t n = 0; n < out.size(); ++n) {
      out[n] = conductor_log_derivative(z, static_cast<double>(n));
    }
    return;
  }
  const Complex<double> one{1.0, 0.0};
  const Complex<double> one_over_z = one / z;
  std::size_t n = starting_order(size, out.size());
  Complex<double> here{static_cast<double>(n) * one_over_z.re,
                       static_cast<double>(n) * one_over_z.im};
  for (; n > 0; --n) {
    // J_{n-1} = n/z J_n + J_n' and J_{n-1}' = (n-1)/z J_{n-1} - J_n.
    const auto order = static_cast<double>(n);
    const Complex<double> order_over_z{order * one_over_z.re, order * one_over_z.im};
    here = order_over_z - one_over_z - one / (order_over_z + here);
    if (n - 1 < out.size()) {
      out[n - 1] = here;
    }
  }
}

}  // namespace rayloc
