// Track: one target through time: its filter and the state of its life cycle.
//
//   tentative --enough bursts--> confirmed --silence--> coasting --too long--> lost
//                                    ^-------burst---------'
//
// Time is that of the frames; no clock is read. METHODS B6: successive bursts share the errors of
// the model, so they are not independent evidence at any rate: the bursts of a walker add up to one
// snapshot in `evidence_time`, and those through an unchanged channel to one at most.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/channel/csi_frame.h"
#include "engine/grid/cell_mass.h"
#include "engine/localize/localizer.h"
#include "engine/track/channel_change.h"
#include "engine/track/filtered_estimate.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"
#include "engine/track/layer_weights.h"

namespace rayloc {

struct TrackOptions {
  MotionModel motion;
  // Correlation time of the model error along a walk: the bursts within it together weigh as much
  // as one snapshot, at any rate of frames.
  Duration evidence_time = std::chrono::milliseconds(400);
  // Share of the power that differs between two bursts when the device has moved by a quarter of
  // the wavelength: that of a room with three quarters of the power in the line of sight.
  double moved_change = 0.25;
  // Share of the power that differs between two bursts of a device at rest, beyond their noise:
  // changes of its own radio. From `walking_ratio` times as much on, the device certainly walks:
  // even with nearly all power in the line of sight, steps of a few centimetres change more.
  double still_change = 0.005;
  double walking_ratio = 5.0;
  std::size_t confirming_bursts = 5;
  Duration coast_after = std::chrono::milliseconds(500);  // time without a burst, to coasting
  Duration forget_after = std::chrono::seconds(1);        // the same, from tentative to lost
  Duration lose_after = std::chrono::seconds(5);          // the same, from any state to lost
  // [1/s], rate at which a height becomes uncertain again, by a change to another height.
  double height_change_rate = 0.05;
  double height_speed = 0.1;  // [m/s], vertical speed of a carried device
  // Compares every burst with the whole room and keeps the whole room in the filter: the reference
  // for the restricted search.
  bool is_exhaustive = false;
};

// Reason why a moment gave no estimate.
enum class MomentRefusal {
  kOutOfOrder,   // not later than the last moment of the track
  kUnusable,     // no access point received usable frames
  kUnexplained,  // no place of the room explains the moment
};

class Track {
 public:
  // `localizer` and `space` have the same grid. `phase`: time offset of the evaluations of the
  // whole room, different for each target so that they do not coincide.
  Track(std::shared_ptr<const Localizer> localizer,
        std::shared_ptr<const FreeSpace> space,
        const TrackOptions& options,
        Duration phase = {});

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
  Timestamp received() const { return received_; }  // last usable burst

 private:
  struct Fix {
    Timestamp time;
    Vec3d position;
  };

  bool weigh(const RoomObservation& observation, Duration elapsed);
  SearchFocus focus() const;
  bool is_joined(const RoomObservation& observation) const;
  bool widens(bool is_joining) const;
  Localizer::Evidence evaluate(const RoomObservation& observation, bool& is_wide);
  void narrow(Duration reach);
  void enter(TrackState state, Timestamp time, std::string reason, FilteredEstimate& estimate);
  void advance(Timestamp time);
  FilteredEstimate predict(Timestamp time);
  FilteredEstimate summarise(LocationEstimate location, const RefinedCells& within) const;
  void remember(FilteredEstimate& estimate);

  Duration phase_;
  std::shared_ptr<const Localizer> localizer_;
  TrackOptions options_;
  TargetChannel change_;  // since the last usable burst
  std::shared_ptr<const FreeSpace> space_;
  GridFilter filter_;
  std::optional<TrackState> state_;  // empty before the first usable burst
  Timestamp time_;                   // time of the filter
  Timestamp received_;               // last usable burst
  Timestamp searched_;               // last evaluation of the whole room
  Duration whole_room_period_;       // time to its next evaluation
  std::vector<std::optional<Timestamp>>
      searched_with_;         // its last evaluation, [ArrayObservation::ap]
  std::size_t bursts_ = 0;    // usable bursts
  bool is_unlocated_ = true;  // no usable burst yet, or the place was forgotten
  double credit_ = 0.0;       // share of a snapshot's weight already given to the present channel
  double loss_ = 0.0;         // at the last position
  // From the last frames: all evidence of the filter relies on the same chains, equally suspect.
  FrameFault fault_;
  // Distribution inside the best cells, from the last weighed burst.
  RefinedCells within_;
  LayerWeights layers_;
  std::deque<Fix> fixes_;  // positions of the last second
};

}  // namespace rayloc
