// Track: one target through time: its filter and the state of its life cycle.
//
//   tentative --enough bursts--> confirmed --silence--> coasting --too long--> lost
//                                    ^-------burst---------'
//
// Time is that of the frames; no clock is read. METHODS B6: successive bursts share the errors of
// the model, so they are not independent evidence at any rate: the bursts of a walker add up to one
// snapshot in `evidence_time`, and those through an unchanged channel to one at most.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/track/filtered_estimate.h"
#include "engine/track/follow/target_filter.h"
#include "engine/track/follow/track_options.h"
#include "engine/track/free_space.h"
#include "engine/track/recent_fixes.h"
#include "engine/track/target_channel.h"

namespace rayloc {

// Reason why a moment gave no estimate.
enum class MomentRefusal {
  kOutOfOrder,   // not later than the last moment of the track
  kUnusable,     // no access point received usable frames
  kUnexplained,  // no place of the room explains the moment
};

class Track {
 public:
  // `localizer` and `space` have the same grid. `phase`: time offset of the evaluations of the
  // whole room, different for each target so that they do not coincide. `cloud`: without a room the
  // grid follows.
  Track(std::shared_ptr<const Localizer> localizer,
        std::shared_ptr<const FreeSpace> space,
        const TrackOptions& options,
        Duration phase = {},
        CloudSource cloud = {});

  // Reduces the memory until the next call.
  void compact();

  // Updates with frames of the target within a moment in which it does not move.
  tl::expected<FilteredEstimate, MomentRefusal> receive(std::span<const CsiFrame> frames,
                                                        const FrameFault& fault = {});

  // Earlier bursts may have been wrong: the target may be anywhere, and the track continues.
  void forget_place();

  // The target has been silent until `now`. Empty unless the track coasts or is lost.
  std::optional<FilteredEstimate> coast(Timestamp now);

  // Ends the track as after a long silence, with this reason. REQUIRES: state().
  FilteredEstimate end(std::string reason);

  // Empty before the first usable burst.
  std::optional<TrackState> state() const { return state_; }
  Timestamp received() const { return received_; }            // last burst that gave an estimate
  bool is_in_cloud() const { return filter_.is_in_cloud(); }  // for tests

 private:
  void enter(TrackState state, Timestamp time, std::string reason, FilteredEstimate& estimate);
  std::optional<double> weigh(const RoomObservation& observation,
                              const std::optional<TargetChannel::Change>& change,
                              std::span<const CsiFrame> frames,
                              Duration elapsed);
  tl::expected<FilteredEstimate, MomentRefusal> move_estimate(std::span<const CsiFrame> frames);
  FilteredEstimate predict(Timestamp time);
  FilteredEstimate summarise(LocationEstimate location, bool is_predicted);
  void remember(FilteredEstimate& estimate);

  std::shared_ptr<const Localizer> localizer_;
  TrackOptions options_;
  TargetChannel channel_;
  TargetFilter filter_;
  // Compact, from before the first prediction since a moment had weight; else empty.
  std::optional<TargetFilter> before_silence_;
  std::optional<TrackState> state_;  // empty before the first usable burst
  Timestamp received_;               // last burst that gave an estimate
  Timestamp weighed_;                // the last one that did not only move the estimate
  std::size_t bursts_ = 0;           // usable ones
  double credit_ = 0.0;  // share of a snapshot's weight already given to the present channel
  // From the last frames: all evidence of the filter relies on the same chains, equally suspect.
  FrameFault fault_;
  RecentFixes fixes_;
  std::optional<FilteredEstimate> last_;  // of a target in a cloud: at `weighed_`
};

}  // namespace rayloc
