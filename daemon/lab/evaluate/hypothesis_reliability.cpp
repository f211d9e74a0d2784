#include "daemon/lab/evaluate/hypothesis_reliability.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/posterior/horizontal_gaussian.h"

namespace rayloc {
namespace {

// The number of the hypothesis that the truth belongs to; empty: none of them.
std::optional<std::size_t> right_one(const LocationEstimate& estimate, const Vec3d& truth) {
  constexpr double kRegion99 = 9.210340371976184;  // -2 ln 0.01
  std::optional<std::size_t> best;
  double most = 0.0;
  for (std::size_t i = 0; i < estimate.hypotheses.size(); ++i) {
    const Hypothesis& hypothesis = estimate.hypotheses[i];
    const auto gaussian = HorizontalGaussian::create(hypothesis.position, hypothesis.covariance);
    if (!gaussian || gaussian->squared_distance(truth.x, truth.y) > kRegion99) {
      continue;
    }
    const double density = hypothesis.weight * gaussian->density(truth.x, truth.y);
    if (density > most) {
      most = density;
      best = i;
    }
  }
  return best;
}

ReliabilityBin summarize(const std::vector<StatedOutcome>& outcomes) {
  ReliabilityBin bin;
  bin.count = outcomes.size();
  const auto n = static_cast<double>(outcomes.size());
  for (const StatedOutcome& outcome : outcomes) {
    bin.stated += outcome.stated / n;
    bin.happened += outcome.happened ? 1.0 / n : 0.0;
  }
  constexpr double kDeviations = 1.959963984540054;  // for a normal distribution, 95 %
  const double z2 = kDeviations * kDeviations;
  const double middle = (bin.happened + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = kDeviations / (1.0 + z2 / n) *
                      std::sqrt(bin.happened * (1.0 - bin.happened) / n + z2 / (4.0 * n * n));
  bin.lower = std::max(0.0, middle - half);
  bin.upper = std::min(1.0, middle + half);
  return bin;
}

}  // namespace

StatedOutcomes stated_outcomes(std::span<const TruthPoint> truth,
                               std::span<const LocationEstimate* const> matches) {
  RAYLOC_CHECK(truth.size() == matches.size());
  StatedOutcomes outcomes;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const LocationEstimate* estimate = matches[i];
    if (estimate == nullptr || !estimate->position || estimate->hypotheses.empty()) {
      continue;
    }
    const auto right = right_one(*estimate, truth[i].position);
    for (std::size_t k = 0; k < estimate->hypotheses.size(); ++k) {
      outcomes.hypotheses.push_back({estimate->hypotheses[k].weight, right == k});
    }
    outcomes.left_over.push_back({estimate->residual_probability, !right});
  }
  return outcomes;
}

std::vector<ReliabilityBin> reliability(std::span<const StatedOutcome> outcomes, std::size_t bins) {
  RAYLOC_CHECK(bins > 0);
  std::vector<std::vector<StatedOutcome>> sorted(bins);
  for (const StatedOutcome& outcome : outcomes) {
    const double share = std::clamp(outcome.stated, 0.0, 1.0) * static_cast<double>(bins);
    sorted[std::min(static_cast<std::size_t>(share), bins - 1)].push_back(outcome);
  }
  std::vector<ReliabilityBin> result;
  for (const auto& bin : sorted) {
    if (!bin.empty()) {
      result.push_back(summarize(bin));
    }
  }
  return result;
}

}  // namespace rayloc
