// place_fusion: the joint likelihood of several access points (access_point_fusion.h) at single
// places, in single precision.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/field_kernel.h"
#include "engine/posterior/access_point_fusion.h"

namespace rayloc {

// Least value of a place. A place that was not compared has it for every access point.
inline constexpr auto kNoMass = static_cast<float>(AccessPointFusion::kNothing);

// values: [access point][place], log-likelihoods relative to the null model, padded to a multiple
// of 8; the size of the fusion. Result: l of each place, padded like them, not below kNoMass, and
// equal to AccessPointFusion::log_likelihood() except for rounding.
std::vector<float> fused_log_likelihood(std::span<const std::vector<float>> values,
                                        const AccessPointFusion& fusion,
                                        double likelihood_exponent);

// Terms of each access point for fuse_rows(), without log-likelihoods. highest: the largest
// log-likelihood of each one, which has a mass of about 1.
std::vector<FusedArray> fused_arrays(const AccessPointFusion& fusion,
                                     double likelihood_exponent,
                                     std::span<const float> highest);

// ln of the mean of exp(exponent l) over the first `count` places: those of kNoMass add nothing to
// the sum and are counted. -inf if there are no others.
double log_mean_of(std::span<const float> log_likelihood, std::size_t count, double exponent);

}  // namespace rayloc
