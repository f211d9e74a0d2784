#include "daemon/lab/calibrate/held_out_fixes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "daemon/lab/evaluate/error_statistics.h"
#include "engine/localize/localizer.h"
#include "engine/posterior/tempering_exponent.h"

namespace rayloc {
namespace {

constexpr std::size_t kMinFixes = 10;
constexpr double kSameHeight = 0.05;  // [m]
// Exponents are tried in order until the score has fallen this many times.
constexpr std::size_t kFalls = 2;
// Map errors are common to all access points, so the likelihoods
// of several carry less information than their product.
constexpr double kMaxExponentOfSeveral = 0.8;

// A fix assumes the height: at other heights its error does not measure its certainty.
std::vector<HeldOutPoint> at_height(std::span<const HeldOutPoint> points, double height) {
  std::vector<HeldOutPoint> there;
  std::copy_if(points.begin(), points.end(), std::back_inserter(there), [&](const auto& point) {
    return std::abs(point.position.z - height) <= kSameHeight;
  });
  return there;
}

struct Tried {
  HeldOutFixes outcome;
  TemperingExponent evaluated;
};

Tried fixes_with(const Localizer& localizer,
                 std::span<const HeldOutPoint> points,
                 double likelihood_exponent,
                 std::span<const double> sigmas,
                 double survey_sigma) {
  Tried tried;
  HeldOutFixes& result = tried.outcome;
  result.likelihood_exponent = likelihood_exponent;
  result.points = points.size();
  std::vector<double> errors;
  std::vector<LocationEstimate> estimates;
  const RoomModel& room = localizer.room();
  KnownPlaces known{{}, survey_sigma, room.area()};
  for (const HeldOutPoint& point : points) {
    known.places.push_back(point.position);
    estimates.push_back(localizer.locate(point.frames, likelihood_exponent));
    const LocationEstimate& estimate = estimates.back();
    if (!estimate.position) {
      continue;
    }
    const double error = std::hypot(estimate.position->x - point.position.x,
                                    estimate.position->y - point.position.y);
    ++result.fixes;
    result.within_accuracy += error <= estimate.accuracy_m ? 1U : 0U;
    errors.push_back(error);
  }
  result.sigma_floor = room.sigma_floor;
  if (!estimates.empty()) {
    tried.evaluated =
        evaluate_exponent(likelihood_exponent, estimates, room.sigma_floor, known, sigmas);
    result.sigma_floor = tried.evaluated.sigma_floor;
    result.log_score = tried.evaluated.score;
    result.dishonesty = tried.evaluated.dishonesty;
  }
  if (!errors.empty()) {
    result.median_error_m = percentile(std::move(errors), 0.5);
  }
  return tried;
}

}  // namespace

Expected<std::vector<HeldOutFixes>> fit_certainty_of(std::shared_ptr<const RoomModel> room,
                                                     std::span<const HeldOutPoint> all,
                                                     double survey_sigma) {
  const std::vector<HeldOutPoint> points = at_height(all, room->device.height);
  const double usual = room->likelihood_exponent;
  const double most = room->access_points.size() > 1 ? kMaxExponentOfSeveral : kExponents.front();
  const std::array usual_sigma{room->sigma_floor};
  const auto localizer = Localizer::create(std::move(room), {});
  RAYLOC_TRY(localizer);
  if (points.size() < kMinFixes) {
    return std::vector<HeldOutFixes>{
        fixes_with(*localizer, points, usual, usual_sigma, survey_sigma).outcome};
  }
  std::vector<HeldOutFixes> outcomes;
  std::vector<TemperingExponent> evaluated;
  std::size_t top = 0;
  for (const double exponent : kExponents) {
    if (exponent > most) {
      continue;
    }
    auto [outcome, evaluation] =
        fixes_with(*localizer, points, exponent, kSigmaFloors, survey_sigma);
    outcomes.push_back(outcome);
    evaluated.push_back(std::move(evaluation));
    if (outcome.fixes < kMinFixes) {
      return std::vector<HeldOutFixes>{
          fixes_with(*localizer, points, usual, usual_sigma, survey_sigma).outcome};
    }
    if (evaluated.back().score > evaluated[top].score) {
      top = evaluated.size() - 1;
    } else if (evaluated.size() - 1 - top >= kFalls) {
      break;
    }
  }
  const auto best = outcomes.begin() + static_cast<std::ptrdiff_t>(best_exponent(evaluated));
  std::rotate(best, best + 1, outcomes.end());
  return outcomes;
}

}  // namespace rayloc
