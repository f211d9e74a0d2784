// TargetFilter: the distribution of a target's position through time, on the grid of the room or in
// a cloud of places.
//
//                    narrow for some time
//   GridFollower ----------------------------> CloudFollower
//         ^-------------------------------------------'
//      broad, not there, a rival is better, an access point joins, unexplained
//
// The grid finds a target; the cloud follows it at a cost that does not depend on the room.
// Used by one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/track/cloud_room.h"
#include "engine/track/follow/cloud_follower.h"
#include "engine/track/follow/grid_follower.h"
#include "engine/track/follow/track_options.h"
#include "engine/track/follow/tracked_moment.h"
#include "engine/track/free_space.h"

namespace rayloc {

// The cloud that may follow a target.
struct CloudSource {
  std::shared_ptr<const CloudRoom> room;  // null: the grid follows
  std::uint64_t seed = 0;                 // of the target; its random numbers follow from it
};

class TargetFilter {
 public:
  // As GridFollower. REQUIRES: source.room has the same localizer and space.
  TargetFilter(std::shared_ptr<const Localizer> localizer,
               std::shared_ptr<const FreeSpace> space,
               TrackOptions options,
               Duration phase,
               CloudSource source);

  TargetFilter(const TargetFilter& other);
  TargetFilter(TargetFilter&&) = default;
  TargetFilter& operator=(const TargetFilter&) = delete;
  TargetFilter& operator=(TargetFilter&&) = default;
  ~TargetFilter() = default;

  // False if these frames need no evaluation: the last estimate is moved instead.
  bool is_due(std::span<const CsiFrame> frames) const { return !cloud_ || cloud_->is_due(frames); }
  bool is_in_cloud() const { return cloud_ != nullptr; }
  Timestamp time() const { return time_; }  // of the last advance() or rest()

  // As GridFollower.
  void compact();
  void wake();
  void advance(Timestamp time);
  void rest(Timestamp time);
  std::optional<double> weigh(const TrackedMoment& moment);
  void forget_place();
  // Sets region_exponent: TrackOptions::lone_exponent with one access point, otherwise 1.
  void summarise(PosteriorOptions options, bool is_predicted, LocationEstimate& location);

  double stationary() const;
  // [m/s], of the target if it is at this position; empty: the positions determine it.
  std::optional<Vec3d> velocity(const Vec3d& position) const;
  double velocity_variance() const;  // [m^2/s^2], of each component; 0 on the grid

  // After the summary of a weighed moment: hands the target over by the rules.
  void settle(bool is_confirmed);

 private:
  void to_cloud();
  void to_grid();

  std::shared_ptr<const Localizer> localizer_;
  std::shared_ptr<const FreeSpace> space_;
  TrackOptions options_;
  Duration phase_;
  CloudSource source_;
  Timestamp time_;
  std::optional<Timestamp> acquiring_since_;  // first moment on the grid; empty: not received yet
  std::unique_ptr<GridFollower> grid_;        // exactly one of the two
  std::unique_ptr<CloudFollower> cloud_;
};

}  // namespace rayloc
