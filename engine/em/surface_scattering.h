// SurfaceScattering: share and directions of the power that a rough surface scatters.
//
// The coefficients and their names are those of Sionna RT, the lobes those of [DE]. A reflected
// field is multiplied by sqrt(1 - S^2); the remaining power is scattered with a random phase
// (scattering_lobe.h).
//
// References:
//   [DE] Degli-Esposti et al.,
//        "Measurement and modelling of scattering from buildings",
//        IEEE Trans. Antennas and Propagation 55(1), 2007.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace rayloc {

enum class ScatteringPattern : std::uint8_t {
  kLambertian,      // the same radiance everywhere
  kDirective,       // ((1 + cos psi_r) / 2)^alpha_r about the mirrored direction
  kBackscattering,  // lambda of that, 1 - lambda of alpha_i about the direction back
};

inline constexpr double kMaxAlpha = 100.0;  // an exponent: above it ScatteringLobe is coarse

// Names in Sionna RT, in the order of ScatteringPattern.
inline constexpr std::array<std::string_view, 3> kScatteringPatternNames{
    "lambertian", "directive", "backscattering"};

struct SurfaceScattering {
  double scattering_coefficient = 0.0;  // S in [0, 1]: S^2 of the reflected power is scattered
  double xpd_coefficient = 0.0;         // k_x in [0, 1], cross-polarised share of that power
  ScatteringPattern pattern = ScatteringPattern::kLambertian;
  double alpha_r = 1.0;  // > 0; the larger, the narrower the lobe
  double alpha_i = 1.0;  // > 0
  double lambda = 1.0;   // in [0, 1], the share of the lobe about the mirrored direction

  bool is_rough() const { return scattering_coefficient > 0.0; }
  // R: factor of the specularly reflected field.
  double specular_factor() const {
    return std::sqrt(1.0 - scattering_coefficient * scattering_coefficient);
  }

  friend bool operator==(const SurfaceScattering&, const SurfaceScattering&) = default;
};

}  // namespace rayloc
