// The transition matrix of an infinite homogeneous elliptic cylinder at any angle to its axis.
//
// Incoming and outgoing waves are the real families sqrt(e_n) J_n(k_t rho) {cos, sin}(n phi) and
// sqrt(e_n) H_n^(2)(k_t rho) {cos, sin}(n phi), e_0 = 1, else 2, phi from the first semi-axis. The
// mirror planes of the ellipse separate four blocks: eta_0 H_z has the symmetry of the derivative
// of E_z along the boundary. Within a block vv and hh are symmetric (reciprocity).
//
// Null-field method: inside, the field radiated by the boundary cancels the incoming wave; the
// condition is imposed on a curve near the boundary. The fields are expanded in regular waves of
// the interior or, in a body so lossy that nothing returns from its middle, in waves that enter its
// surface (impedance boundary condition with curvature).
//
// References:
//   [W] Waterman, Matrix formulation of electromagnetic scattering, Proc. IEEE 53 (1965).
//   [D] Doicu, Wriedt, Eremin, Light scattering by systems of particles (2006): discrete sources.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "engine/base/complex.h"
#include "engine/em/cylinder_boundary.h"

namespace rayloc {

// Row or column k belongs to order symmetry.order(k).
struct TransitionBlock {
  Symmetry symmetry;    // of E_z; eta_0 H_z has symmetry.across()
  Eigen::MatrixXcd vv;  // E_z of E_z
  Eigen::MatrixXcd hh;  // eta_0 H_z of eta_0 H_z
  // E_z of eta_0 H_z, over sin_elevation; eta_0 H_z of E_z is its transpose.
  Eigen::MatrixXcd vh;
  // Deviation of vv and hh from symmetry, a measure of their error (entries are at most 1). It
  // grows with size, flatness and the permittivity of a body that waves pass through.
  double asymmetry = 0.0;
};

// E_z even or odd in y, with even or odd orders: these kinds do not couple.
inline constexpr std::array<Symmetry, 4> kSymmetries{{{Harmonic::kCosine, false},
                                                      {Harmonic::kCosine, true},
                                                      {Harmonic::kSine, false},
                                                      {Harmonic::kSine, true}}};

// k_semi_axes: times the wavenumber of free space. `count`: orders of each symmetry. The blocks are
// in the order of kSymmetries. REQUIRES: 0 < cos_elevation <= 1, count >= 2.
std::array<TransitionBlock, 4> elliptic_transition(const std::array<double, 2>& k_semi_axes,
                                                   const Complex<double>& relative_permittivity,
                                                   double cos_elevation,
                                                   std::size_t count);

}  // namespace rayloc
