// Track: one target through time: its filter, and where in its life it is.
//
//   tentative --enough bursts--> confirmed --unheard--> coasting --too long--> lost
//                                    ^-------heard---------'
//
// Time is that of the frames; nothing here reads a clock. METHODS B6: successive bursts share what
// is wrong with the model, so each counts with a part of the weight that a snapshot has, and bursts
// through the same channel count together as one snapshot at most.
#pragma once

#include <complex>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/observe/alignment.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"

namespace rayloc {

enum class TrackState { kTentative, kConfirmed, kCoasting, kLost };

struct TrackOptions {
  MotionModel motion;
  double exponent = 0.5;  // of a burst's likelihood, beside RoomModel::temper
  // Share of the power that differs between two bursts when the device has moved by a quarter of
  // the wavelength: that of a room where three quarters of the power come the direct way.
  double moved_change = 0.25;
  std::size_t confirming_bursts = 5;
  Duration coast_after = std::chrono::milliseconds(500);  // unheard, a track coasts
  Duration forget_after = std::chrono::seconds(1);        // unheard, a tentative track is lost
  Duration lose_after = std::chrono::seconds(5);          // unheard, any track is lost
};

struct TrackTransition {
  Timestamp time;
  std::optional<TrackState> before;  // nothing: the track begins
  TrackState after = TrackState::kTentative;
  std::string reason;
};

struct FilteredEstimate {
  LocationEstimate location;
  TrackState state = TrackState::kTentative;
  bool predicted = false;         // from earlier bursts only
  std::optional<Vec3d> velocity;  // [m/s], over the last second; absent when that was not heard
  double standing = 0.0;          // probability
  std::optional<TrackTransition> transition;
};

class Track {
 public:
  // `localizer` and `space` belong together: the same grid.
  Track(std::shared_ptr<const Localizer> localizer,
        std::shared_ptr<const FreeSpace> space,
        const TrackOptions& options);

  // Frames of the target within a moment that it does not move in. Nothing when they say nothing
  // (Localizer::hear) or are not later than what the track has seen (`out_of_order()`).
  std::optional<FilteredEstimate> hear(std::span<const CsiFrame> frames);

  // It is `now` and the target has been silent. Nothing unless it coasts, or is lost for good.
  std::optional<FilteredEstimate> coast(Timestamp now);

  // Nothing before the first usable burst.
  std::optional<TrackState> state() const { return state_; }

  std::uint64_t out_of_order() const { return out_of_order_; }

 private:
  struct Fix {
    Timestamp time;
    Vec3d position;
  };

  double change_of(const Hearing& hearing) const;
  bool weigh(const Hearing& hearing);
  void enter(TrackState state, Timestamp time, std::string reason, FilteredEstimate& estimate);
  void advance(Timestamp time);
  FilteredEstimate summarise(LocationEstimate location) const;
  void remember(FilteredEstimate& estimate);

  std::shared_ptr<const Localizer> localizer_;
  TrackOptions options_;
  Aligner aligner_;
  GridFilter filter_;
  std::optional<TrackState> state_;  // nothing before the first usable burst
  Timestamp time_;                   // of the filter
  Timestamp heard_;                  // last usable burst
  std::size_t bursts_ = 0;           // usable ones
  double credit_ = 0.0;              // of a snapshot's weight, given to the present channel
  double loss_ = 0.0;                // at the last position
  std::vector<HeardArray> last_;     // of the last usable burst
  std::deque<Fix> fixes_;            // of the last second
  std::uint64_t out_of_order_ = 0;
};

}  // namespace rayloc
