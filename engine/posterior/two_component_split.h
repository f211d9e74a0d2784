// Splits a peak of a posterior into a core and a foot.
//
// Many peaks are sharp, millimetres wide, on a wide foot: half a cycle beside the peak a part of
// the rays fits again. One Gaussian with the covariance of both makes the peak's core several times
// too wide. Two Gaussians with their weights represent both.
#pragma once

#include <array>
#include <optional>
#include <span>

namespace rayloc {

// Mass of a peak and its distribution: mean and covariance, horizontal.
struct HillMass {
  double mass = 0.0;
  double x = 0.0;  // [m]
  double y = 0.0;
  double xx = 0.0;  // [m^2], about the mean
  double xy = 0.0;
  double yy = 0.0;
};

// The total mass, its mean and its covariance. REQUIRES: positive mass.
HillMass sum_of(std::span<const HillMass> parts);

// The core, which is the denser component, and the foot; together they have the whole mass.
// Computed by expectation maximisation from the densest part on. Empty if one Gaussian describes
// the mass nearly as well: a tenth of a nat less, in the mean over the mass.
std::optional<std::array<HillMass, 2>> two_component_split(std::span<const HillMass> parts);

}  // namespace rayloc
