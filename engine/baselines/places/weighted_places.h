// Weights of surveyed places as an estimate: what methods that know places end in.
//
// The place that is stated is the published one: the mean of the heaviest places by their weights,
// or the heaviest. The uncertainty is ours: every place stands for its surroundings, and the
// weights are tempered, because networks are too sure of what they say.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

inline constexpr std::size_t kHeaviestPlaces = 10;  // that count for the mean, a count, chosen

struct WeightedPlaces {
  std::vector<Vec3d> places;
  std::vector<double> weights;  // probabilities, as the network states them
  double temperature = 1.0;     // weights count by this root for the uncertainty
  double sigma = 0.1;           // [m], of the surroundings of a place
  double residual = 0.02;       // probability of being elsewhere

  // Tempered, sum 1.
  std::vector<double> tempered() const;
  // Logarithm of the density of the tempered weights at a place, in plan [1/m^2].
  double log_density(const Vec3d& place) const;
  Vec3d mean_of_heaviest() const;
  const Vec3d& heaviest() const;
};

// Half of the median distance from a place to the nearest other one, but at least 0.05 m.
double surroundings_of(const std::vector<Vec3d>& places);

// The temperature with which what was held out is most likely, and the share of it that lies
// outside of the regions of 99 %, at least 0.02. `held`: of each a place's weights and the truth.
struct HeldOutPlace {
  WeightedPlaces weighted;
  Vec3d truth;
};
struct PlaceCertainty {
  double temperature = 1.0;
  double residual = 0.02;
};
PlaceCertainty fit_certainty(std::vector<HeldOutPlace> held);

struct PlaceAnswer {
  bool is_heaviest = false;  // the heaviest place; else the mean
  double accuracy_confidence = 0.95;
};

// Fills position, covariance, accuracy, hypotheses and what summarise_plan() does.
void summarise_places(const RoomModel& room,
                      const WeightedPlaces& weighted,
                      const PlaceAnswer& answer,
                      LocationEstimate& estimate);

}  // namespace rayloc
