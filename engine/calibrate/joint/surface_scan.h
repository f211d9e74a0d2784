// Scans of single surfaces over all points, the rest of the room held: find the right half-wave
// cycle and detect when another one fits as well (METHODS B4, step 2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/calibrate/joint/joint_problem.h"

namespace rayloc {

// Mean share of a sample's power that arrives over each surface.
std::vector<double> surface_power(std::span<const TracedSample> samples, const Scene& scene);

// Surfaces with at least `share` of the strongest one's power, strongest first, at most `most`.
std::vector<std::uint32_t> strongest_surfaces(std::span<const double> power,
                                              double share,
                                              std::size_t most);

struct ScanOptions {
  double floor = 0.3;
  double range = 0.05;  // [m], on each side
  double step = 0.002;  // [m]
};

// Moves each relevant surface to the best offset within the range, the strongest first. The device
// is at the place given by state.survey. `power`: surface_power().
void scan_surfaces(const JointContext& context,
                   std::span<const double> power,
                   const ScanOptions& options,
                   JointState& state);

// Adds to the standard deviation of each surface's offset the effect of its other cycles: the
// spread of the posterior over +-6 cm.
void widen_by_other_cycles(const JointContext& context,
                           double floor,
                           const JointState& state,
                           std::vector<double>& sigma);

}  // namespace rayloc
