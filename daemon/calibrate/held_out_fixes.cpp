#include "daemon/calibrate/held_out_fixes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "daemon/evaluate/error_statistics.h"
#include "engine/localize/credible_region.h"
#include "engine/localize/localizer.h"

namespace rayloc {
namespace {

constexpr std::size_t kLeastFixes = 10;
constexpr double kSameHeight = 0.05;  // [m]
// Tried from the first on, until the score has fallen twice.
// 1 is the likelihood as it is; no burst says more than its model. What is wrong with the map is
// wrong for all access points at once, so that the likelihoods of several say less than their
// product: never more than kMostOfSeveral.
constexpr std::array kExponents = {1.0, 0.8, 0.6, 0.45, 0.35, 0.25, 0.18, 0.13, 0.09, 0.06};
constexpr double kMostOfSeveral = 0.8;
constexpr std::size_t kFalls = 2;
// Standard deviation of what dishonesty() says of honest regions.
constexpr double kSpreadOfHonest = 0.76;
constexpr std::array kLeastSigmas = {
    0.001, 0.002, 0.003, 0.005, 0.007, 0.01, 0.014, 0.02, 0.03};  // [m]

// The estimate if its variances were larger by `more` [m^2] on each axis.
LocationEstimate widened(LocationEstimate estimate, double more) {
  const auto widen = [&](std::array<double, 9>& covariance) {
    covariance[0] += more;
    covariance[4] += more;
  };
  widen(estimate.covariance);
  for (Hypothesis& hypothesis : estimate.hypotheses) {
    widen(hypothesis.covariance);
  }
  return estimate;
}

// Of each spot. One without a fix is one that may be anywhere.
std::vector<double> log_scores(std::span<const LocationEstimate> estimates,
                               std::span<const HeldOutSpot> spots,
                               double area,
                               double more) {
  std::vector<double> scores;
  scores.reserve(spots.size());
  for (std::size_t i = 0; i < spots.size(); ++i) {
    scores.push_back(
        std::log(stated_density(widened(estimates[i], more), spots[i].position, area)));
  }
  return scores;
}

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Whether the mean of `better` is above that of `other` by no more than the standard error of the
// difference, spot by spot.
bool is_within_error(std::span<const double> better, std::span<const double> other) {
  std::vector<double> differences(better.size());
  std::transform(better.begin(), better.end(), other.begin(), differences.begin(), std::minus<>());
  const double mean = mean_of(differences);
  double squares = 0.0;
  for (const double difference : differences) {
    squares += (difference - mean) * (difference - mean);
  }
  const auto n = static_cast<double>(differences.size());
  return mean <= std::sqrt(squares / (n * (n - 1.0)));
}

// How far the stated regions are from honest: the statistic of Anderson and Darling of the
// probabilities of the regions that just reach to the spots. Where every region holds as often as
// it says they are anything from 0 to 1, and it is 1 in the mean. What is left over counts as the
// last of the region.
double dishonesty(std::span<const LocationEstimate> estimates,
                  std::span<const HeldOutSpot> spots,
                  double more) {
  constexpr double kLast = 0.999;
  std::vector<double> reaching;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const auto one = region_reaching(widened(estimates[i], more), spots[i].position);
    reaching.push_back(std::clamp(one.value_or(kLast), 1.0 - kLast, kLast));
  }
  std::sort(reaching.begin(), reaching.end());
  const auto n = static_cast<double>(reaching.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < reaching.size(); ++i) {
    sum += (2.0 * static_cast<double>(i) + 1.0) *
           std::log(reaching[i] * (1.0 - reaching[reaching.size() - 1 - i]));
  }
  return -n - sum / n;
}

// A fix assumes the height: elsewhere its error is no sign of how sure it may be.
std::vector<HeldOutSpot> at_height(std::span<const HeldOutSpot> spots, double height) {
  std::vector<HeldOutSpot> there;
  std::copy_if(spots.begin(), spots.end(), std::back_inserter(there), [&](const auto& spot) {
    return std::abs(spot.position.z - height) <= kSameHeight;
  });
  return there;
}

struct Tried {
  HeldOutFixes outcome;
  std::vector<double> scores;  // of each spot
};

Tried fixes_with(const Localizer& localizer,
                 std::span<const HeldOutSpot> spots,
                 double temper,
                 std::span<const double> sigmas,
                 double survey_sigma) {
  Tried tried;
  HeldOutFixes& result = tried.outcome;
  result.temper = temper;
  result.points = spots.size();
  std::vector<double> errors;
  std::vector<LocationEstimate> estimates;
  const RoomModel& room = localizer.room();
  const double area =
      (room.bounds_max.x - room.bounds_min.x) * (room.bounds_max.y - room.bounds_min.y);
  for (const HeldOutSpot& spot : spots) {
    estimates.push_back(localizer.locate(spot.frames, temper));
    const LocationEstimate& estimate = estimates.back();
    if (!estimate.position) {
      continue;
    }
    const double error =
        std::hypot(estimate.position->x - spot.position.x, estimate.position->y - spot.position.y);
    ++result.fixes;
    result.within_accuracy += error <= estimate.accuracy_m ? 1U : 0U;
    errors.push_back(error);
  }
  const double stated = room.least_sigma * room.least_sigma;
  result.least_sigma = room.least_sigma;
  result.log_score = -std::numeric_limits<double>::infinity();
  for (const double sigma : sigmas) {
    auto of_sigma =
        log_scores(estimates, spots, area, sigma * sigma - stated + survey_sigma * survey_sigma);
    const double score = mean_of(of_sigma);
    if (score > result.log_score) {
      result.log_score = score;
      result.least_sigma = sigma;
      tried.scores = std::move(of_sigma);
    }
  }
  result.dishonesty =
      dishonesty(estimates,
                 spots,
                 result.least_sigma * result.least_sigma - stated + survey_sigma * survey_sigma);
  if (!errors.empty()) {
    result.median_error_m = percentile(std::move(errors), 0.5);
  }
  return tried;
}

}  // namespace

Expected<std::vector<HeldOutFixes>> fit_certainty_of(std::shared_ptr<const RoomModel> room,
                                                     std::span<const HeldOutSpot> all,
                                                     double survey_sigma) {
  const std::vector<HeldOutSpot> spots = at_height(all, room->device.height);
  const double usual = room->temper;
  const double most = room->access_points.size() > 1 ? kMostOfSeveral : kExponents.front();
  const std::array usual_sigma{room->least_sigma};
  const auto localizer = Localizer::create(std::move(room), {});
  if (!localizer) {
    return tl::make_unexpected(localizer.error());
  }
  if (spots.size() < kLeastFixes) {
    return std::vector<HeldOutFixes>{
        fixes_with(*localizer, spots, usual, usual_sigma, survey_sigma).outcome};
  }
  std::vector<Tried> tried;
  std::size_t best = 0;
  for (const double exponent : kExponents) {
    if (exponent > most) {
      continue;
    }
    tried.push_back(fixes_with(*localizer, spots, exponent, kLeastSigmas, survey_sigma));
    if (tried.back().outcome.fixes < kLeastFixes) {
      return std::vector<HeldOutFixes>{
          fixes_with(*localizer, spots, usual, usual_sigma, survey_sigma).outcome};
    }
    if (tried.back().outcome.log_score > tried[best].outcome.log_score) {
      best = tried.size() - 1;
    } else if (tried.size() - 1 - best >= kFalls) {
      break;
    }
  }
  // Of exponents that the score of so few spots cannot tell apart (Breiman et al., Classification
  // and Regression Trees, 1984: the rule of one standard error) those with the most honest regions,
  // and of these, for it states the widest, the least.
  std::vector<std::size_t> as_good;
  double least = tried[best].outcome.dishonesty;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (is_within_error(tried[best].scores, tried[i].scores)) {
      as_good.push_back(i);
      least = std::min(least, tried[i].outcome.dishonesty);
    }
  }
  for (const std::size_t i : as_good) {
    best = tried[i].outcome.dishonesty <= least + kSpreadOfHonest ? i : best;
  }
  std::rotate(tried.begin() + static_cast<std::ptrdiff_t>(best),
              tried.begin() + static_cast<std::ptrdiff_t>(best) + 1,
              tried.end());
  std::vector<HeldOutFixes> outcomes;
  std::transform(tried.begin(), tried.end(), std::back_inserter(outcomes), [](const Tried& one) {
    return one.outcome;
  });
  return outcomes;
}

}  // namespace rayloc
