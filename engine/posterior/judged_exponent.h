// What is stated of spots whose places are known, with one exponent of the likelihood, and which
// exponent is to be had.
//
// The exponents are compared by the logarithm of the density that is stated at the places, which
// punishes regions that are too narrow and regions that are too wide alike. Of exponents that the
// score of so few spots cannot tell apart (the rule of one standard error: Breiman et al.,
// Classification and Regression Trees, 1984) those with the most honest regions count, and of
// these, for it states the widest, the least.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

// 1 is the likelihood as it is; no burst says more than its model.
inline constexpr std::array kExponents = {1.0, 0.8, 0.6, 0.45, 0.35, 0.25, 0.18, 0.13, 0.09, 0.06};

// Widths that may be left in every position [m].
inline constexpr std::array kLeastSigmas = {
    0.001, 0.002, 0.003, 0.005, 0.007, 0.01, 0.014, 0.02, 0.03};

struct KnownSpots {
  std::vector<Vec3d> places;  // [m]
  double place_sigma = 0.0;   // [m], of each horizontal axis; no error of an estimate
  double area = 1.0;          // [m^2], in which one may be who has no fix
};

struct JudgedExponent {
  double exponent = 1.0;
  double least_sigma = 0.01;   // [m], of those that were tried the best
  std::vector<double> scores;  // of each spot, log density [1/m^2] stated at its place
  double score = 0.0;          // their mean
  // How far the stated regions are from honest: the statistic of Anderson and Darling of the
  // probabilities of the regions that just reach to the places. Where every region holds as often
  // as it says they are anything from 0 to 1, and it is 1 in the mean. What is left over counts as
  // the last of the region.
  double dishonesty = 0.0;
};

// estimates: of each spot with that exponent and `stated_sigma` as the least width [m], in whose
// place `least_sigmas` are tried. REQUIRES: an estimate for each spot, and a width.
JudgedExponent judge_exponent(double exponent,
                              std::span<const LocationEstimate> estimates,
                              double stated_sigma,
                              const KnownSpots& spots,
                              std::span<const double> least_sigmas = kLeastSigmas);

// The index of the one to be had. REQUIRES: not empty; all judged the same spots, exponents fall.
std::size_t best_exponent(std::span<const JudgedExponent> judged);

}  // namespace rayloc
