#include "engine/calibrate/check/misfitting_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/base/median.h"
#include "engine/calibrate/check/paired_comparison.h"
#include "engine/calibrate/fixed_text.h"
#include "engine/calibrate/log_odds.h"

namespace rayloc {
namespace {

// The usual fit at an access point.
struct Usual {
  double share = 0.0;
  double log_odds = 0.0;
  double deviation = 0.0;
};

std::optional<Usual> usual_fit(const std::vector<double>& shares) {
  if (shares.size() < kMinPairs) {
    return std::nullopt;
  }
  // Lower bound: shares that agree to the last digit must not cause a refusal of the next one.
  constexpr double kMinDeviation = 0.3;
  // A ratio: sigma of a normal distribution over its median deviation.
  constexpr double kOfNormal = 1.4826;
  // Uncertainty of the deviation of n values itself: twice its relative error, 1.17 / sqrt(n).
  const double allowance = 1.0 + 2.0 * 1.17 / std::sqrt(static_cast<double>(shares.size()));
  Usual usual;
  usual.share = median(shares);
  usual.log_odds = log_odds(usual.share);
  std::vector<double> away;
  away.reserve(shares.size());
  for (const double share : shares) {
    away.push_back(std::abs(log_odds(share) - usual.log_odds));
  }
  usual.deviation = allowance * std::max(kOfNormal * median(std::move(away)), kMinDeviation);
  return usual;
}

}  // namespace

std::vector<PointRefusal> misfitting_points(const RoomModel& room,
                                            std::span<const PointFit> fits,
                                            double PointFit::*share) {
  std::map<std::size_t, std::vector<double>> shares;  // by access point
  for (const PointFit& fit : fits) {
    shares[fit.access_point].push_back(fit.*share);
  }
  struct Sum {
    double deviations = 0.0;
    double count = 0.0;
    std::string own;
    std::string others;
  };
  std::map<std::size_t, Sum> sums;  // by point
  for (const auto& [ap, of_ap] : shares) {
    const auto usual = usual_fit(of_ap);
    for (const PointFit& fit : fits) {
      if (!usual || fit.access_point != ap) {
        continue;
      }
      Sum& sum = sums[fit.point];
      sum.deviations += (log_odds(fit.*share) - usual->log_odds) / usual->deviation;
      sum.count += 1.0;
      sum.own += (sum.own.empty() ? "" : ", ") + fixed_text(fit.*share) + " (" +
                 room.access_points.at(ap).id + ")";
      sum.others += (sum.others.empty() ? "" : ", ") + fixed_text(usual->share);
    }
  }
  std::vector<PointRefusal> refused;
  for (const auto& [point, sum] : sums) {
    if (sum.deviations / std::sqrt(sum.count) < -kFarBelow) {
      refused.push_back({point,
                         "fits its place by " + sum.own + " where the others fit by " + sum.others +
                             ": wrong place or time?"});
    }
  }
  return refused;
}

}  // namespace rayloc
