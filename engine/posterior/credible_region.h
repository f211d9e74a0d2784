// The credible regions of an estimate, of 50 %, 95 %, ... probability, and the density at a
// position.
//
// The posterior of an estimate is a Gaussian mixture (its hypotheses with their weights) and an
// outlier probability, "somewhere else". Its region of probability p is the highest-density one:
// the smallest that holds p. Somewhere else has the least density, so it is part of the region only
// if p exceeds the sum of the weights; then the region is everything. The posterior of an estimate
// without hypotheses is one Gaussian, its position and covariance.
// Horizontal: x and y only.
#pragma once

#include <optional>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

// The probability of the smallest stated region that reaches to `truth`: the truth lies in the
// region of probability p if and only if this value is below p. Empty if the estimate has no
// position or no valid covariance. Exact for one Gaussian, otherwise to about 0.01.
std::optional<double> region_reaching(const LocationEstimate& estimate, const Vec3d& truth);

// Stated density [1/m^2] at `truth`, with the outlier probability spread over `area` [m^2]; only
// that part without a position or valid covariance. Positive if the outlier probability is.
double stated_density(const LocationEstimate& estimate, const Vec3d& truth, double area);

// Squared Mahalanobis distance of `truth` by the horizontal covariance of the whole posterior; mean
// 2 for a correct covariance. Empty as above.
std::optional<double> normalized_squared_error(const LocationEstimate& estimate,
                                               const Vec3d& truth);

}  // namespace rayloc
