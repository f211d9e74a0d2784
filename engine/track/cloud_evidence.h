// CloudEvidence: the weights that a moment gives to the places of a cloud, relative to the mean
// over the room. The mean is that of the cloud and of a few boxes of the room, which the time of
// the moment selects.
//
// It keeps the mean likelihoods of each access point, smoothed over some moments. Results follow
// from the arguments and the moments before, not from threads or other devices. Used by one thread
// at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/localize/place_search.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/track/cloud_room.h"
#include "engine/track/place_cloud.h"

namespace rayloc {

class CloudEvidence {
 public:
  // [array][place], padded: the values of an observation at places, as
  // PlaceSearch::log_likelihoods() gives them. Called twice for a moment: for the cloud, and for
  // the sample of the room.
  using Compare = std::function<std::vector<std::vector<float>>(
      const RoomObservation&, const SearchedPlaces&, PlaceSearch::Spread)>;
  // compare: empty for PlaceSearch; other ones in tests.
  explicit CloudEvidence(std::shared_ptr<const CloudRoom> room, Compare compare = {});

  // Least probability that a moment carries no information, chosen: no place loses more than all
  // but this share of its weight, relative to the mean.
  static constexpr double kMinOutlier = 0.05;

  struct Weights {
    // [place], padded to a multiple of 8: (1 - o) exp(w t l - m) + o; 0 for a place without a box.
    std::vector<float> factor;
    double outlier = 0.0;  // o, a probability: the moment is uninformative
    float best = 0.0F;     // largest l of the cloud
  };
  // boxes: of each place (CloudRoom::lattice), or BoxLattice::kNone: an impossible place.
  // weight: w in (0, 1]. Empty if no place, of the cloud or of the sample, explains the moment, or
  // no place has a box: then no state changes.
  // REQUIRES: boxes.size() == cloud.size(), the observation has arrays; without a Compare of a
  // test, PlaceSearch::can_search(observation).
  std::optional<Weights> weigh(const RoomObservation& observation,
                               const PlaceCloud& cloud,
                               std::span<const std::uint32_t> boxes,
                               double weight);

 private:
  using Terms = AccessPointFusion::Terms;
  // Values of a moment, [array][place]; then of all arrays together.
  struct Compared {
    std::vector<std::size_t> ap;  // [array], ArrayObservation::ap
    std::vector<std::vector<float>> cloud;
    std::vector<std::vector<float>> sample;
    std::size_t places = 0;  // of the cloud
  };
  struct Fused {
    std::vector<float> cloud;
    std::vector<float> sample;
  };

  Compared compared(const RoomObservation& observation,
                    const PlaceCloud& cloud,
                    std::span<const std::uint32_t> boxes) const;
  double log_mean(std::span<const float> cloud,
                  std::span<const float> sample,
                  std::size_t places,
                  double exponent) const;
  std::vector<Terms> log_means(const Compared& values) const;
  AccessPointFusion fusion_of(const std::vector<Terms>& means) const;
  Fused fused(const Compared& values, const AccessPointFusion& fusion) const;
  double outlier(const Compared& values, const std::vector<Terms>& now) const;
  std::vector<Terms> smoothed(const Compared& values, const std::vector<Terms>& now) const;

  std::shared_ptr<const CloudRoom> room_;
  Compare compare_;
  double exponent_;                             // RoomModel::likelihood_exponent
  std::vector<std::optional<Terms>> log_mean_;  // smoothed, by ArrayObservation::ap
};

}  // namespace rayloc
