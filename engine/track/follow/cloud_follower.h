// CloudFollower: follows a target by a cloud of places (CloudFilter), and evaluates the whole room
// every few seconds, at times that differ between targets.
//
// Used by one thread at a time.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/track/cloud_filter.h"
#include "engine/track/cloud_room.h"
#include "engine/track/follow/track_options.h"
#include "engine/track/follow/tracked_moment.h"
#include "engine/track/follow/weighed_access_points.h"

namespace rayloc {

class CloudFollower {
 public:
  // phase: time offset of the evaluations of the whole room. weighed: by the follower before.
  CloudFollower(std::shared_ptr<const CloudRoom> room,
                CloudFilter filter,
                TrackOptions options,
                Duration phase,
                WeighedAccessPoints weighed);

  bool is_due(std::span<const CsiFrame> frames) const { return filter_.is_due(frames); }
  void advance(Timestamp time) { filter_.advance(time); }
  void rest(Timestamp time) { filter_.rest(time); }
  // The share of a snapshot's weight that the present channel has then; empty if the grid must
  // search for the target, with this moment too.
  std::optional<double> weigh(const TrackedMoment& moment);

  // As CloudFilter; the loss is filled, too.
  void summarise(const PosteriorOptions& options, LocationEstimate& location);
  Vec3d velocity(const Vec3d& position) const { return filter_.velocity(position); }
  double velocity_variance() const { return filter_.velocity_variance(); }
  double stationary() const { return filter_.cloud().resting(); }

  // After a summary: draws the places again where needed. False if the grid must take the target
  // back.
  bool settle();
  // Share of the mass that the grid spreads over the room when it takes the target back.
  double spread() const;
  const PlaceCloud& cloud() const { return filter_.cloud(); }
  const WeighedAccessPoints& weighed() const { return weighed_; }

 private:
  void search_room(const RoomObservation& observation, double weight);

  std::shared_ptr<const CloudRoom> room_;
  CloudFilter filter_;
  TrackOptions options_;
  Duration phase_;
  WeighedAccessPoints weighed_;
  Timestamp searched_;      // last evaluation of the whole room, or the hand-over
  Duration search_period_;  // time to the next one
  double lead_ = 0.0;       // rival_lead()
  double outside_ = 0.0;    // probability that the target was beside the area in the last summary
};

}  // namespace rayloc
