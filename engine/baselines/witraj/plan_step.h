// One step of a walking person, from the rates of the lengths of paths via the person [WT]:
//
//   (e_T + e_i) . dp = v_i dt     for each access point i
//
// with unit vectors from the transmitter and from the access point to the person, in plan.
#pragma once

#include <array>
#include <span>

#include "engine/base/vec3.h"

namespace rayloc {

struct PathRateAt {
  Vec3d access_point;  // [m]
  double rate = 0.0;   // [m/s]
};

struct PlanStep {
  double x = 0.0;  // [m]
  double y = 0.0;
  std::array<double, 4> by_rate{};  // 2 x 2, covariance of the step for rates of variance 1 [m^2]
};

// From `place`, in `seconds`, by the midpoint rule, in least squares. The step is damped near the
// line of sight, where the equations are singular. REQUIRES: at least two rates.
PlanStep plan_step(const Vec3d& transmitter,
                   std::span<const PathRateAt> rates,
                   const Vec3d& place,
                   double seconds);

}  // namespace rayloc
