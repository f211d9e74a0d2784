// PersonTracker: one person without a device through time (METHODS B5, B6), by what the bursts of
// fixed transmitters say of every place of the room.
//
//   nobody --seen--> tentative --seen often enough--> confirmed --not seen--> coasting --> lost
//
// The filter is that of devices (grid_filter.h). Nobody says here whose burst it is: a track begins
// when somebody is seen, and a second person is not told from the first.
//
// Thread safety: for one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/localize/person_localizer.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"
#include "engine/track/track.h"

namespace rayloc {

struct PersonTrackerOptions {
  // People walk at up to 1.4 m/s, and what they stand in the way of makes them turn.
  MotionModel motion{.walking_speeds = {0.7, 1.4}, .direction_time = 0.5};
  // Frames of all access points within this are one measurement: an echo past a walker turns by
  // half a cycle in 12 ms, so frames of one access point are not averaged.
  Duration moment = std::chrono::milliseconds(10);
  // Between the moments that are looked at. What lies between them says little more of the place.
  Duration interval = std::chrono::milliseconds(80);
  // For which what is wrong with the model stays the same along a walk: the moments within it weigh
  // as much as one snapshot.
  Duration evidence_time = std::chrono::milliseconds(250);
  // Share by which what the person adds must change until it is news; 1: by itself. Shadows change
  // slowly, and are most of what a person adds.
  double moved_change = 0.03;
  std::size_t confirming_moments = 5;
  Duration coast_after = std::chrono::milliseconds(500);  // unseen, a track coasts
  Duration forget_after = std::chrono::seconds(1);        // unseen, a tentative track is lost
  Duration lose_after = std::chrono::seconds(5);          // unseen, any track is lost
};

struct PersonUpdate {
  std::uint64_t track = 1;  // from 1; a number is never used again
  FilteredEstimate estimate;
};

class PersonTracker {
 public:
  PersonTracker(std::shared_ptr<const PersonLocalizer> localizer, PersonTrackerOptions options);

  // Appends an estimate for every moment of the burst in which there is a track. `frames`: of the
  // reference's transmitter, in order of time.
  void hear(std::span<const CsiFrame> frames, std::vector<PersonUpdate>& updates);

  // The track ends, for that reason: time may go back.
  void restart(const std::string& reason, std::vector<PersonUpdate>& updates);

  std::uint64_t out_of_order() const { return out_of_order_; }  // moments refused
  std::uint64_t passed_over() const { return passed_over_; }    // frames between the moments

 private:
  struct Life {
    GridFilter filter;
    TrackState state = TrackState::kTentative;
    std::size_t moments = 0;  // in which somebody was seen
    Timestamp seen;
    Timestamp weighed;    // last moment that was
    double credit = 0.0;  // of a snapshot's weight, given to the present channel
    std::vector<PersonHearing::Array> last;
  };

  void hear_moment(std::span<const CsiFrame> frames, std::vector<PersonUpdate>& updates);
  void begin(Timestamp time);
  double change_of(const PersonHearing& hearing) const;
  bool weigh(const PersonHearing& hearing);
  std::optional<TrackTransition> age(Timestamp time, bool is_seen);
  PersonUpdate summarise(LocationEstimate location,
                         bool is_seen,
                         std::optional<TrackTransition> transition) const;

  std::shared_ptr<const PersonLocalizer> localizer_;
  PersonTrackerOptions options_;
  std::shared_ptr<const FreeSpace> space_;
  std::optional<Life> life_;
  std::optional<Timestamp> time_;  // of the last moment
  std::uint64_t track_ = 0;        // number of the last one
  std::uint64_t out_of_order_ = 0;
  std::uint64_t passed_over_ = 0;
};

}  // namespace rayloc
