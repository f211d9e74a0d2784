// Reliability of hypothesis weights: is a hypothesis of weight 0.3 the right one in 30 % of cases,
// and is the truth "somewhere else" as often as the residual probability states?
//
// Exactly one outcome of each estimate occurs: the truth belongs to one of its hypotheses, or to
// none of them. It belongs to the one with the largest weighted density there, if it lies in that
// one's own region of 99 %; otherwise it belongs to none.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "daemon/lab/evaluate/truth.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

struct StatedOutcome {
  double stated = 0.0;  // probability
  bool happened = false;
};

struct StatedOutcomes {
  std::vector<StatedOutcome> hypotheses;
  std::vector<StatedOutcome> left_over;
};

// Outcomes of the estimates that have a position and hypotheses. matches[i] is the estimate for
// truth[i]; nullptr: none. REQUIRES: same length.
StatedOutcomes stated_outcomes(std::span<const TruthPoint> truth,
                               std::span<const LocationEstimate* const> matches);

// Outcomes of similar stated probability.
struct ReliabilityBin {
  double stated = 0.0;  // mean
  double happened = 0.0;
  double lower = 0.0;  // Wilson's interval of 95 % for `happened`
  double upper = 1.0;
  std::size_t count = 0;
};

// Equal bins of [0, 1]; empty ones are left out.
std::vector<ReliabilityBin> reliability(std::span<const StatedOutcome> outcomes, std::size_t bins);

}  // namespace rayloc
