// RadioMaterial: material properties of a surface at one frequency; and the materials of ITU-R
// P.2040-4 by name.
//
// Time factor exp(+j w t): the complex relative permittivity is eps_r - j sigma / (w eps_0).
//
// References:
//   [P2040] Rec. ITU-R P.2040-3, equations (28), (29) and table 3, with the rows of P.2040-4.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/complex.h"
#include "engine/base/expected.h"
#include "engine/em/surface_scattering.h"

namespace rayloc {

inline constexpr double kDefaultThickness = 0.1;  // [m], where a scene states none (as Sionna RT)
inline constexpr double kHalfSpace = std::numeric_limits<double>::infinity();  // [m], a thickness

struct RadioMaterial {
  std::string name;
  double relative_permittivity = 1.0;    // real part, >= 1
  double conductivity = 0.0;             // [S/m], >= 0
  double thickness = kDefaultThickness;  // [m], > 0; kHalfSpace: no second face
  SurfaceScattering scattering = {};     // used only with TraceOptions::diffuse

  friend bool operator==(const RadioMaterial&, const RadioMaterial&) = default;
};

// eps_r - j sigma / (2 pi f eps_0).
Complex<double> complex_permittivity(const RadioMaterial& material, double frequency_hz);

// Names of the table, as scenes write them after "itu_": "concrete", "brick", "ceiling_board", ...
std::span<const std::string> itu_material_names();

// The material at that frequency. An Error (without a place, which the caller adds) when the table
// has no such name, with a suggestion, or does not cover the frequency, with its range.
Expected<RadioMaterial> itu_material(std::string_view name,
                                     double frequency_hz,
                                     double thickness = kDefaultThickness);

// An Error when a value is not physical or not finite.
Expected<void> validate(const RadioMaterial& material);

}  // namespace rayloc
