#include "engine/person/calibrate/person_certainty.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "engine/base/check.h"
#include "engine/person/people.h"
#include "engine/posterior/posterior.h"
#include "engine/posterior/tempering_exponent.h"

namespace rayloc {
namespace {

constexpr std::size_t kFolds = 3;  // a count, chosen: each third is tested with a fit of the others
// Points needed to estimate the largest gain of a second person, and the smallest value reported
// for it.
constexpr std::size_t kMinHeldOutPoints = 20;
constexpr double kMinGain = 20.0;  // [nat], chosen: lower bound of a second person's gain

// Gain of the best second person; 0 where none is searched for.
double second_gain(const PersonLocalizer& localizer, const PersonObservation& observation) {
  if (observation.arrays.empty()) {
    return 0.0;
  }
  const double likelihood_exponent = localizer.reference().person.likelihood_exponent;
  const auto pair = best_pair(
      localizer, observation, likelihood_exponent, localizer.map(observation, likelihood_exponent));
  return pair ? pair->gain : 0.0;
}

}  // namespace

Expected<PersonCertainty> fit_person_certainty(const RoomModel& room,
                                               const PersonFit& fit,
                                               std::span<const PersonPoint> points,
                                               std::span<const std::vector<CsiFrame>> frames,
                                               const PersonFitOptions& options) {
  RAYLOC_CHECK(points.size() == frames.size());
  const auto shared = std::make_shared<const RoomModel>(room);
  PersonFitOptions same_body = options;
  same_body.radius_steps.clear();
  std::array<std::vector<LocationEstimate>, kExponents.size()> estimates;  // by point
  KnownPlaces known{{}, options.place_sigma, room.area()};
  double gain = kMinGain;
  for (std::size_t part = 0; part < kFolds; ++part) {
    std::vector<PersonPoint> others;
    for (std::size_t s = 0; s < points.size(); ++s) {
      if (s % kFolds != part) {
        others.push_back(points[s]);
      }
    }
    auto fitted = fit_person(room, fit.reference, others, same_body);
    RAYLOC_TRY(fitted);
    const auto localizer = PersonLocalizer::create(shared, std::move(fitted->reference), {});
    RAYLOC_TRY(localizer);
    for (std::size_t s = part; s < points.size(); s += kFolds) {
      const PersonObservation observation = localizer->receive(frames[s]);
      if (observation.arrays.empty()) {
        continue;
      }
      known.places.push_back({points[s].place.x, points[s].place.y, 0.0});
      for (std::size_t t = 0; t < kExponents.size(); ++t) {
        estimates[t].push_back(
            localizer->summarise(observation.estimate, localizer->map(observation, kExponents[t])));
      }
      gain = std::max(gain, second_gain(*localizer, observation));
    }
  }
  PersonCertainty certainty;
  if (!known.places.empty()) {
    // Places known to a centimetre cannot reveal a smaller error floor of all positions.
    const std::array usual{PosteriorOptions{}.sigma_floor};
    std::vector<TemperingExponent> evaluated;
    for (std::size_t t = 0; t < kExponents.size(); ++t) {
      evaluated.push_back(
          evaluate_exponent(kExponents[t], estimates[t], usual.front(), known, usual));
    }
    certainty.likelihood_exponent = evaluated[best_exponent(evaluated)].exponent;
  }
  if (known.places.size() >= kMinHeldOutPoints) {
    certainty.second_person = gain;
  }
  return certainty;
}

}  // namespace rayloc
