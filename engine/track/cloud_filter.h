// CloudFilter: the places of one target through time, weighed by its moments.
//
// Its random numbers follow from the target, the time and their purpose, and from no counter: two
// filters with the same cloud and the same moments have the same bytes.
//
// Used by one thread at a time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/normal_draws.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/grid/height_layers.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/track/cloud_evidence.h"
#include "engine/track/cloud_room.h"
#include "engine/track/cloud_summary.h"
#include "engine/track/place_cloud.h"

namespace rayloc {

struct CloudOptions {
  CloudMotion motion;
  // Counts of places. Three access points make hills of centimetres, which fewer places cover.
  std::size_t places_of_one = 1500;  // with one access point
  std::size_t places_of_more = 600;
  std::size_t places_at_first = 6000;  // a third fewer in each moment, down to the above
  // Least time between two compared moments of one access point: its hills are wide, and moments
  // in between add nothing to `evidence_time`.
  Duration moment_of_one = std::chrono::milliseconds(90);
  double least_effective = 0.5;  // share of the places; below it they are drawn again
};

// Purpose of a filter's random numbers.
enum class CloudDraw : std::uint64_t { kPredict = 1, kThin = 2, kHandOver = 3 };
// seed: of the target.
NormalDraws cloud_draws(std::uint64_t seed, Timestamp time, CloudDraw purpose);

class CloudFilter {
 public:
  // compare: as CloudEvidence, empty outside of tests.
  CloudFilter(std::shared_ptr<const CloudRoom> room,
              const CloudOptions& options,
              std::uint64_t seed,
              PlaceCloud cloud,
              Timestamp time,
              CloudEvidence::Compare compare = {});

  // False for frames of one access point too soon after others of it: the estimate is moved
  // instead.
  bool is_due(std::span<const CsiFrame> frames) const;
  // These frames were compared, or needed no comparison.
  void note(std::span<const CsiFrame> frames);

  // Time passes. A place that passes a wall or leaves the free cells loses its weight.
  // REQUIRES: not before the time of the filter.
  void advance(Timestamp time);
  // Time passes, and the target does not move. REQUIRES: as advance().
  void rest(Timestamp time);
  // As PlaceCloud::weigh_change.
  void weigh_change(double change, double odds) { cloud_.weigh_change(change, odds); }
  // False if no place explains the moment, or none is left: then nothing changes. weight: in (0,
  // 1], of a snapshot.
  bool weigh(const RoomObservation& observation, double weight);
  // Draws the places again where needed. After the summary, which is that of the weighed places.
  void thin();

  const PlaceCloud& cloud() const { return cloud_; }
  Timestamp time() const { return time_; }
  double away() const;  // probability that the target is at none of the places
  double loss() const { return loss_; }
  // Fills the fields of summarise_cloud(); away() and the mass outside the area are added to
  // options.outlier. Returns the latter, a probability.
  double summarise(PosteriorOptions options, LocationEstimate& location) const;
  Vec3d velocity(const Vec3d& position) const { return velocity_of(cloud_, position); }
  // [m^2/s^2], of each component of the velocity, over all places.
  double velocity_variance() const;

 private:
  // Places after the next draw.
  std::size_t next_count() const;

  std::shared_ptr<const CloudRoom> room_;
  CloudOptions options_;
  std::uint64_t seed_;
  PlaceCloud cloud_;
  Timestamp time_;
  CloudEvidence evidence_;
  double log_odds_;                   // that the target is at one of the places
  double loss_ = 0.0;                 // at the best place of the last moment
  bool is_alone_ = false;             // the last moment was of one access point
  Timestamp noted_;                   // last frame of the last noted ones ...
  std::vector<std::size_t> senders_;  // ... and their access points
};

}  // namespace rayloc
