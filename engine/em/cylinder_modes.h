// Scattering by an infinite homogeneous circular cylinder, order by order, at any angle to its
// axis.
//
// Fields depend on z as exp(-j k sin_elevation z). With u = (E_z, eta_0 H_z) and the wavenumber
// across the axis k_t = k cos_elevation, an incoming J_n(k_t rho) exp(j n phi) produces
// an outgoing T_n H_n^(2)(k_t rho) exp(j n phi); T_n is a 2 x 2 matrix. Without loss 1 +
// 2 T_n is unitary.
//
// References:
//   [W] Wait, Scattering of a plane wave from a circular dielectric cylinder at oblique incidence,
//       Can. J. Phys. 33 (1955); derived anew in cylinder_modes.cpp for our time factor.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/complex.h"

namespace rayloc {

// Coefficients of the orders 0, 1, ...; vv and hh are even in the order, cross is odd.
struct CylinderModes {
  std::vector<Complex<double>> vv;  // E_z of E_z
  std::vector<Complex<double>> hh;  // eta_0 H_z of eta_0 H_z
  // E_z of eta_0 H_z, over sin_elevation, which is minus eta_0 H_z of E_z.
  std::vector<Complex<double>> cross;
};

// Number of orders that scatter: terms beyond it are below 1e-8 of the largest.
std::size_t cylinder_order_count(double k_radius);

// k_radius: wavenumber of free space times the radius. relative_permittivity: Im <= 0, Re >= 1.
// REQUIRES: k_radius > 0, 0 < cos_elevation <= 1, orders >= 2.
CylinderModes circular_modes(double k_radius,
                             const Complex<double>& relative_permittivity,
                             double cos_elevation,
                             std::size_t orders);

}  // namespace rayloc
