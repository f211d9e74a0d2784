// Evaluates the estimates at reference points for each exponent of the likelihood, and selects the
// exponent.
//
// The exponents are compared by the logarithm of the density stated at the true positions, which
// penalises regions that are too narrow and regions that are too wide alike. Among exponents that
// the scores of so few points cannot separate (the rule of one standard error: Breiman et al.,
// Classification and Regression Trees, 1984), those with the most honest regions are kept, and of
// these the least, since it states the widest regions.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

// 1 is the likelihood itself; no burst is more informative than its model.
inline constexpr std::array kExponents = {1.0, 0.8, 0.6, 0.45, 0.35, 0.25, 0.18, 0.13, 0.09, 0.06};

// Candidates of the residual width of every position [m].
inline constexpr std::array kSigmaFloors = {
    0.001, 0.002, 0.003, 0.005, 0.007, 0.01, 0.014, 0.02, 0.03};

struct KnownPlaces {
  std::vector<Vec3d> places;  // [m]
  double place_sigma = 0.0;   // [m], of each horizontal axis; not an error of an estimate
  double area = 1.0;          // [m^2], area in which a device without a fix may be
};

struct TemperingExponent {
  double exponent = 1.0;
  double sigma_floor = 0.01;   // [m], the best of the candidates
  std::vector<double> scores;  // log density [1/m^2] stated at each point
  double score = 0.0;          // mean of the scores
  // Distance of the stated regions from honest ones: the Anderson-Darling statistic of the
  // probabilities of the regions that just reach to the positions. If every region holds as often
  // as stated, these are uniform from 0 to 1, and the statistic is 1 in the mean. The outlier
  // probability counts as the last part of the region.
  double dishonesty = 0.0;
};

// estimates: one for each point, with that exponent and `stated_sigma` as the least width [m],
// which is replaced by each of `sigma_floors`. REQUIRES: an estimate for each point, and a width.
TemperingExponent evaluate_exponent(double exponent,
                                    std::span<const LocationEstimate> estimates,
                                    double stated_sigma,
                                    const KnownPlaces& known,
                                    std::span<const double> sigma_floors = kSigmaFloors);

// The index of the best one. REQUIRES: not empty; all for the same points, exponents descending.
std::size_t best_exponent(std::span<const TemperingExponent> evaluated);

}  // namespace rayloc
