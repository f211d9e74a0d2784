// GridFollower: follows a target by a mass for every cell of the room (GridFilter).
//
// A moment is compared with the cells where the target may be, and with the whole room after the
// target might have been anywhere, periodically, and when an access point joins.
//
// Used by one thread at a time.
#pragma once

#include <memory>
#include <optional>

#include "engine/base/timestamp.h"
#include "engine/grid/cell_mass.h"
#include "engine/localize/localizer.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/track/follow/track_options.h"
#include "engine/track/follow/tracked_moment.h"
#include "engine/track/follow/weighed_access_points.h"
#include "engine/track/follow/window_evidence.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"
#include "engine/track/layer_weights.h"
#include "engine/track/place_cloud.h"

namespace rayloc {

class GridFollower {
 public:
  // The target may be anywhere. `localizer` and `space` have the same grid. `phase`: time offset of
  // the periodic evaluations of the whole room.
  GridFollower(std::shared_ptr<const Localizer> localizer,
               std::shared_ptr<const FreeSpace> space,
               const TrackOptions& options,
               Duration phase);

  // The same for a target that a cloud has followed until `time`; `elsewhere`: share of the mass
  // that is spread over the room. The next moment counts as a whole snapshot, so that it decides
  // between the places of the cloud and all others.
  void continue_from(const PlaceCloud& cloud,
                     double elsewhere,
                     WeighedAccessPoints weighed,
                     Timestamp time);

  // Reduces the memory until wake(), which comes before any other call.
  void compact();
  void wake() { filter_.wake(); }

  void advance(Timestamp time);
  // Time passes, and the target does not move: its channel is the same.
  void rest(Timestamp time);
  // The share of a snapshot's weight that the present channel has then; empty if no place of the
  // room explains the moment.
  std::optional<double> weigh(const TrackedMoment& moment);
  // The target may be anywhere.
  void forget_place();

  // Fills the fields that summarise_posterior() fills, and the loss. options.outlier: that of the
  // frames. is_predicted: no moment was weighed at this time.
  void summarise(const PosteriorOptions& options,
                 bool is_predicted,
                 LocationEstimate& location) const;
  double stationary() const { return filter_.stationary(); }

  // The state, for a hand-over. REQUIRES: not compacted.
  const GridFilter& filter() const { return filter_; }
  const RefinedCells& within() const { return within_; }
  const LayerWeights& layers() const { return layers_; }
  const WeighedAccessPoints& weighed() const { return weighed_; }

 private:
  bool widens(bool is_joining) const;
  Localizer::Evidence evaluate(const RoomObservation& observation, bool& is_wide);
  SearchFocus focus() const;
  void narrow(Duration reach);
  double take(Localizer::Evidence evidence,
              const CellWindow& compared,
              const MomentWeights& weights);

  Duration phase_;
  std::shared_ptr<const Localizer> localizer_;
  TrackOptions options_;
  std::shared_ptr<const FreeSpace> space_;
  GridFilter filter_;
  bool has_begun_ = false;  // a moment was weighed, or a cloud was taken over
  Timestamp time_;          // time of the filter
  Timestamp searched_;      // last evaluation of the whole room
  Duration whole_room_period_ = kFirstWholeRoomPeriod;  // time to its next evaluation
  WeighedAccessPoints weighed_;
  std::size_t moments_ = 0;   // weighed ones
  bool is_unlocated_ = true;  // no moment was weighed since the target might be anywhere
  double loss_ = 0.0;         // at the last position
  RefinedCells within_;       // distribution inside the best cells, from the last weighed moment
  LayerWeights layers_;
};

}  // namespace rayloc
