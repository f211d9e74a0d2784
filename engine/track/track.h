// Track: one target through time: its filter, and where in its life it is.
//
//   tentative --enough bursts--> confirmed --unheard--> coasting --too long--> lost
//                                    ^-------heard---------'
//
// Time is that of the frames; nothing here reads a clock. METHODS B6: successive bursts share what
// is wrong with the model, so they are not evidence of their own however fast they come: a walker's
// add up to one snapshot in `evidence_time`, and those through the same channel to one at most.
#pragma once

#include <complex>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/observe/alignment.h"
#include "engine/track/filtered_estimate.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"

namespace rayloc {

struct TrackOptions {
  MotionModel motion;
  // For which what is wrong with the model stays the same along a walk: the bursts within it weigh
  // as much as one snapshot, at any rate of frames.
  Duration evidence_time = std::chrono::milliseconds(400);
  // Share of the power that differs between two bursts when the device has moved by a quarter of
  // the wavelength: that of a room where three quarters of the power come the direct way.
  double moved_change = 0.25;
  // Share of the power that differs between two bursts of a device at rest, beyond their noise: its
  // radio's own changes. From `walking_ratio` times as much on, the device certainly walks: even
  // where nearly all power comes the direct way, steps of a few centimetres change more.
  double still_change = 0.005;
  double walking_ratio = 5.0;
  std::size_t confirming_bursts = 5;
  Duration coast_after = std::chrono::milliseconds(500);  // unheard, a track coasts
  Duration forget_after = std::chrono::seconds(1);        // unheard, a tentative track is lost
  Duration lose_after = std::chrono::seconds(5);          // unheard, any track is lost
  // [1/s], by which a height is less known again: of being another than before.
  double height_change_rate = 0.05;
  double height_speed = 0.1;  // [m/s], of a device that is carried
  // Every burst is compared with the whole room, and the filter keeps all of it: the reference of
  // what is compared where the device may be.
  bool is_exhaustive = false;
};

// Why a moment gave no estimate.
enum class MomentRefusal {
  kOutOfOrder,   // not later than what the track has seen
  kUnusable,     // no access point heard anything that can be used
  kUnexplained,  // no place of the room explains it
};

class Track {
 public:
  // `localizer` and `space` belong together: the same grid. `phase`: of the moments at which the
  // whole room is looked at, another one for each target, so that not all are at once.
  Track(std::shared_ptr<const Localizer> localizer,
        std::shared_ptr<const FreeSpace> space,
        const TrackOptions& options,
        Duration phase = {});

  // Takes little memory until the next call.
  void rest();

  // Frames of the target within a moment that it does not move in.
  tl::expected<FilteredEstimate, MomentRefusal> hear(std::span<const CsiFrame> frames,
                                                     const FrameDoubt& doubt = {});

  // What was heard so far may have been wrong: the target may be anywhere, and is followed on.
  void forget_place();

  // It is `now` and the target has been silent. Nothing unless it coasts, or is lost for good.
  std::optional<FilteredEstimate> coast(Timestamp now);

  // The track ends as if it had not been heard for too long, for that reason. REQUIRES: state().
  FilteredEstimate end(std::string reason);

  // Nothing before the first usable burst.
  std::optional<TrackState> state() const { return state_; }
  Timestamp heard() const { return heard_; }  // last usable burst

 private:
  // What is compared with the next burst.
  struct Earlier {
    std::size_t ap = 0;                   // HeardArray::ap
    std::vector<std::complex<double>> h;  // HeardArray::h
  };
  struct Fix {
    Timestamp time;
    Vec3d position;
  };

  std::optional<double> change_of(const RoomObservation& observation) const;
  double motion_of(double change, const RoomObservation& observation) const;
  bool weigh(const RoomObservation& observation, Duration elapsed);
  SearchFocus focus() const;
  bool is_joined(const RoomObservation& observation) const;
  bool widens(bool is_joining) const;
  Localizer::Evidence look(const RoomObservation& observation, bool& is_wide);
  void spread_height(double seconds);
  void learn_height(const std::vector<double>& mass, double weight);
  void narrow(Duration reach);
  void enter(TrackState state, Timestamp time, std::string reason, FilteredEstimate& estimate);
  void advance(Timestamp time);
  FilteredEstimate predict(Timestamp time);
  FilteredEstimate summarise(LocationEstimate location, const KnownCells& within) const;
  void remember(FilteredEstimate& estimate);

  Duration phase_;
  std::shared_ptr<const Localizer> localizer_;
  TrackOptions options_;
  Aligner aligner_;
  std::shared_ptr<const FreeSpace> space_;
  GridFilter filter_;
  std::optional<TrackState> state_;  // nothing before the first usable burst
  Timestamp time_;                   // of the filter
  Timestamp heard_;                  // last usable burst
  Timestamp looked_;                 // at the whole room, last
  Duration whole_room_period_;       // until it is looked at again
  std::vector<std::optional<Timestamp>>
      looked_with_;            // last look with its frames, [HeardArray::ap]
  std::size_t bursts_ = 0;     // usable ones
  bool knows_nothing_ = true;  // of the place: no usable burst yet, or forgotten
  double credit_ = 0.0;        // of a snapshot's weight, given to the present channel
  double loss_ = 0.0;          // at the last position
  // Of the last frames: all that the filter holds rests on the same chains, and is doubted alike.
  FrameDoubt doubt_;
  // Where in a cell its mass is, of the best cells of the last burst that was weighed.
  KnownCells within_;
  std::vector<double> layers_;  // probability of each layer of heights; empty: known, or the prior
  std::vector<Earlier> last_;   // of the last usable burst
  std::deque<Fix> fixes_;       // of the last second
};

}  // namespace rayloc
