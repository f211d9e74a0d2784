#include "engine/em/cylinder_modes.h"

#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/em/cylinder_bessel.h"

namespace rayloc {

std::size_t cylinder_order_count(double k_radius) {
  return static_cast<std::size_t>(k_radius + 4.0 * std::cbrt(k_radius) + 10.0);
}

// Outside u = J_n + A H_n, inside u ~ J_n(y), times exp(j n phi). E_z, H_z and the tangential
//   E_phi = -j / k_t^2 (k_z d_phi E_z - k d_rho eta H_z),
//   eta H_phi = -j / k_t^2 (k_z d_phi eta H_z + k eps_r d_rho E_z)
// are continuous. With q = (k_t outside / inside)^2 that is, for the slopes outside,
//   d_rho E_z    = q eps_r d_rho E_z inside    - sin (1 - q) d_phi eta H_z,
//   d_rho eta H_z = q      d_rho eta H_z inside + sin (1 - q) d_phi E_z,
// and the slopes inside are the logarithmic derivative of J_n(y) times the value.
CylinderModes circular_modes(double k_radius,
                             const Complex<double>& relative_permittivity,
                             double cos_elevation,
                             std::size_t orders) {
  RAYLOC_CHECK(k_radius > 0.0 && cos_elevation > 0.0 && cos_elevation <= 1.0 && orders >= 2);
  using C = Complex<double>;
  const C one{1.0, 0.0};
  const double sin2 = 1.0 - cos_elevation * cos_elevation;
  const double x = k_radius * cos_elevation;
  const C inside2 = relative_permittivity - C{sin2, 0.0};  // (k_t inside / k)^2
  const C root = sqrt(inside2);
  const C y{k_radius * root.re, k_radius * root.im};
  const C q = C{cos_elevation * cos_elevation, 0.0} / inside2;

  // One order more, for the slopes.
  std::vector<double> j(orders + 1);
  std::vector<C> h(orders + 1);
  std::vector<C> log_derivative(orders);
  bessel_orders(x, j);
  hankel_orders(x, h);
  log_derivative_orders(y, log_derivative);

  CylinderModes modes;
  modes.vv.resize(orders);
  modes.hh.resize(orders);
  modes.cross.resize(orders);
  const C y_over_x = y / C{x, 0.0};
  for (std::size_t i = 0; i < orders; ++i) {
    const auto n = static_cast<double>(i);
    const double slope_j = n / x * j[i] - j[i + 1];
    const C slope_h = C{n / x, 0.0} - h[i + 1] / h[i];  // over H_n, which may be huge
    const C in_h = q * y_over_x * log_derivative[i];
    const C in_v = relative_permittivity * in_h;
    const C turn = (one - q) * C{n / x, 0.0};  // times j sin
    const C turn2 = C{sin2, 0.0} * turn * turn;
    const C jn{j[i], 0.0};
    const C dj{slope_j, 0.0};
    const C determinant = (slope_h - in_v) * (slope_h - in_h) - turn2;
    const C scale = C{-1.0, 0.0} / (determinant * h[i]);
    modes.vv[i] = scale * ((slope_h - in_h) * (dj - in_v * jn) - turn2 * jn);
    modes.hh[i] = scale * ((slope_h - in_v) * (dj - in_h * jn) - turn2 * jn);
    // The Wronskian J_n H_n' - J_n' H_n = -2j / (pi x).
    modes.cross[i] = scale * turn * C{2.0 / (std::numbers::pi * x), 0.0} / h[i];
  }
  return modes;
}

}  // namespace rayloc
