// Weights of surveyed places as an estimate: the last step of the place classifiers.
//
// The reported place is the published one: the mean of the heaviest places by their weights, or the
// heaviest. The uncertainty is ours: every place represents its surroundings, and the weights are
// tempered, because networks are overconfident.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

inline constexpr std::size_t kHeaviestPlaces = 10;  // places in the mean, a count, chosen

struct WeightedPlaces {
  std::vector<Vec3d> places;
  std::vector<double> weights;  // probabilities, as output by the network
  double temperature = 1.0;     // the uncertainty uses the weights' root of this order
  double sigma = 0.1;           // [m], of the surroundings of a place
  double residual = 0.02;       // outlier probability

  // Tempered weights, sum 1.
  std::vector<double> tempered() const;
  // Logarithm of the density of the tempered weights at a place, in plan [1/m^2].
  double log_density(const Vec3d& place) const;
  Vec3d mean_of_heaviest() const;
  const Vec3d& heaviest() const;
};

// Half of the median distance from a place to the nearest other one, but at least 0.05 m.
double surroundings_of(const std::vector<Vec3d>& places);

// The temperature that maximises the likelihood of the held-out places, and the share of them
// outside the regions of 99 %, at least 0.02. `held`: weights and true position of each.
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
  bool is_heaviest = false;  // the heaviest place; otherwise the mean
  double accuracy_confidence = 0.95;
};

// Sets position, covariance, accuracy, hypotheses and the fields of summarise_plan().
void summarise_places(const RoomModel& room,
                      const WeightedPlaces& weighted,
                      const PlaceAnswer& answer,
                      LocationEstimate& estimate);

}  // namespace rayloc
