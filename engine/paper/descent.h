// The descent of the paper's localization (METHODS A4): RMSprop on a loss of the position, smoothed
// by a Gaussian of shrinking width, in plan; the height is constant.
//
// A step at P with width sigma takes N_p positions u_j ~ N(P, sigma^2), with the losses L_j,
//   B_j = exp(-alpha L_j),  g_j = exp(-|u_j - P|^2 / (2 sigma^2)),
//   gradient = 1/N_p sum_j g_j B_j grad L_j         (B_j held constant: no derivative of its own)
//   sigma   <- sigma_0 - beta (t / T) (sigma_0 - sigma_m),   beta = 2 / (1 + exp(softmax(B)_c)).
// The paper leaves three choices open. g is the density relative to its peak: its scale depends on
// sigma only, and RMSprop is invariant to scale. c is the position nearest to P. beta is between
// 0.54 and 1 (METHODS C6), so that the final sigma is 1 - beta of sigma_0.
//
// P and all u_j are kept within the bounds: a position outside is set to the nearest one inside.
// RMSprop with the paper's rate and momentum moves 7.5 m in 100 steps, so a large room needs
// several starts (METHODS C7).
#pragma once

#include <cstddef>
#include <functional>
#include <random>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/paper/rmsprop.h"

namespace rayloc::paper {

struct DescentOptions {
  int iterations = 100;           // T
  std::size_t positions = 5;      // N_p
  double variance = 1.0;          // sigma_0^2 [m^2]
  double least_deviation = 0.01;  // sigma_m [m]
  double alpha = 0.2;
  double rate = 0.03;  // [m]
  RmspropOptions rmsprop = {.decay = 0.9, .momentum = 0.6, .least = 1e-8};
  // Ablations. Without smoothing: the gradient at P itself. Fixed: constant sigma_0.
  bool is_smoothed = true;
  bool is_deviation_fixed = false;
};

// An Error (kUsage) for invalid numbers.
Expected<void> validate(const DescentOptions& options);

// A loss at a position and its derivatives in plan [1/m].
struct LossInPlan {
  double value = 0.0;
  double by_x = 0.0;
  double by_y = 0.0;
};

struct Descent {
  Vec3d position;
  double deviation = 0.0;  // final sigma [m]; a parameter of the search, not an uncertainty
};

// Bounds in plan; the height is ignored.
struct PlanBounds {
  Vec3d min;
  Vec3d max;
  Vec3d nearest(const Vec3d& position) const;
};

// `loss` is called from several threads. The result depends only on the arguments and the state of
// `random`, which is advanced. REQUIRES: valid options, min <= max.
Descent descend(const std::function<LossInPlan(const Vec3d&)>& loss,
                const Vec3d& start,
                const PlanBounds& bounds,
                const DescentOptions& options,
                std::mt19937_64& random);

}  // namespace rayloc::paper
