// Scans of single surfaces over all points, the rest of the room held: what finds the right
// half-wave cycle, and what tells when another one would do as well (METHODS B4, step 2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/calibrate/joint/joint_problem.h"

namespace rayloc {

// Mean share of a sample's power that comes by way of each surface.
std::vector<double> surface_power(std::span<const TracedSample> samples, const Scene& scene);

// Those with at least `share` of the strongest one's power, the strongest first, `most` at most.
std::vector<std::uint32_t> strongest_surfaces(std::span<const double> power,
                                              double share,
                                              std::size_t most);

struct ScanOptions {
  double floor = 0.3;
  double range = 0.05;  // [m], to either side
  double step = 0.002;  // [m]
};

// Moves each surface that matters to the best place within the range, the strongest first. The
// device stands where state.survey says. `power`: surface_power().
void scan_surfaces(const JointContext& context,
                   std::span<const double> power,
                   const ScanOptions& options,
                   JointState& state);

// Adds to the standard deviation of each surface's offset what its other cycles are worth: the
// spread of the posterior over +-6 cm.
void widen_by_other_cycles(const JointContext& context,
                           double floor,
                           const JointState& state,
                           std::vector<double>& sigma);

}  // namespace rayloc
