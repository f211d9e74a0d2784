// A hill of a posterior as a core and a foot.
//
// Many a hill is a sharp peak, millimetres wide, on a wide foot: half a cycle beside the peak a
// part of the rays fits again. One Gaussian with the covariance of both states the peak's middle
// several times too wide. Two Gaussians with their weights state either as it is.
#pragma once

#include <array>
#include <optional>
#include <span>

namespace rayloc {

// Mass of a hill and where it is: mean and covariance, horizontal.
struct HillMass {
  double mass = 0.0;
  double x = 0.0;  // [m]
  double y = 0.0;
  double xx = 0.0;  // [m^2], about the mean
  double xy = 0.0;
  double yy = 0.0;
};

// The mass of all, its mean and its covariance. REQUIRES: some mass.
HillMass sum_of(std::span<const HillMass> parts);

// The core, which is the denser one, and the foot; together they have the mass of all. By
// expectation and maximisation from the densest part on. Nothing where one Gaussian says nearly as
// much of where the mass is: a tenth of a nat less, in the mean over the mass.
std::optional<std::array<HillMass, 2>> two_component_split(std::span<const HillMass> parts);

}  // namespace rayloc
