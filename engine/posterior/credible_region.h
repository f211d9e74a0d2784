// What an estimate states about where the target is not: its regions of 50 %, 95 %, ...
// probability.
//
// The posterior that an estimate states is a Gaussian mixture (its hypotheses with their weights)
// and the probability that is left over, "somewhere else". Its region of probability p is the
// highest-density one: the smallest that holds p. Somewhere else has the least density, so that it
// is part of the region only when p exceeds the sum of the weights; then the region is everything.
// An estimate without hypotheses states one Gaussian, its position and covariance.
// Horizontal: x and y alone.
#pragma once

#include <optional>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

// The probability of the smallest stated region that reaches to `truth`: the truth lies in the
// region of probability p if and only if this is below p. Nothing when the estimate has no position
// or states no covariance that is one. Exact for one Gaussian, otherwise to about 0.01.
std::optional<double> region_reaching(const LocationEstimate& estimate, const Vec3d& truth);

// Density [1/m^2] of what is stated at `truth`, "somewhere else" spread over `area` [m^2]; that
// alone without a position or a covariance that is one. More than 0 when something is left over.
double stated_density(const LocationEstimate& estimate, const Vec3d& truth, double area);

// Squared Mahalanobis distance of `truth` by the horizontal covariance of the whole posterior; mean
// 2 where that is right. Nothing as above.
std::optional<double> normalized_squared_error(const LocationEstimate& estimate,
                                               const Vec3d& truth);

}  // namespace rayloc
