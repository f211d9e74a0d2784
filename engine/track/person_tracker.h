// PersonTracker: one person without a device through time (METHODS B5, B6), by what the bursts of
// fixed transmitters say of every place of the room.
//
//   nobody --seen--> tentative --seen often enough--> confirmed --not seen--> coasting --> lost
//
// The filter is that of devices (grid_filter.h). Nobody says here whose burst it is: a track begins
// when somebody is seen, and a second person is not told from the first.
//
// Who is not seen any more is predicted at every moment that is heard, and while the transmitter is
// silent at fixed times after the last moment: what is stated does not depend on how often
// advance() is called.
//
// Thread safety: for one thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/person/person_localizer.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"
#include "engine/track/looked_cells.h"
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
  // The same of a body that is not round (PersonModel::front_sigma), heard by one access point:
  // what is wrong stays as long as the body walks the same way. Several see it from other sides.
  Duration one_sided_evidence_time = std::chrono::milliseconds(500);
  // Share by which what the person adds must change until it is news; 1: by itself. Shadows change
  // slowly, and are most of what a person adds.
  double moved_change = 0.03;
  std::size_t confirming_moments = 5;
  Duration coast_after = std::chrono::milliseconds(500);  // unseen, a track coasts
  Duration forget_after = std::chrono::seconds(1);        // unseen, a tentative track is lost
  Duration lose_after = std::chrono::seconds(5);          // unseen, any track is lost
  // Without a clear sight, as a track needs to begin, any track is lost: a link that hears little
  // of a person hears as much of an empty room, and one who has left would stay for ever.
  Duration doubt_after = std::chrono::seconds(10);
  // Every moment is compared with the whole room: the reference of looking where somebody may be.
  bool is_exhaustive = false;
  // Between two predicted positions while the transmitter is silent.
  Duration coasting_interval = std::chrono::milliseconds(200);
  // Tracks are numbered first_number, first_number + number_step, ...: trackers of several
  // transmitters never use the same number, whichever sees somebody first.
  std::uint64_t first_number = 1;
  std::uint64_t number_step = 1;
  // Before it another tracker has numbered all, the next but first_number: who is lost before then
  // gives the number back.
  Timestamp numbered_before = Timestamp::min();
  // The last moment that the other one has looked at: the next is `interval` later.
  std::optional<Timestamp> last_moment = std::nullopt;
};

// moments = used + nobody + unexplained + out_of_order + unusable; begun = lost + tracks now.
struct PersonTrackerCounters {
  std::uint64_t begun = 0;         // tracks
  std::uint64_t lost = 0;          // tracks
  std::uint64_t moments = 0;       // measurements
  std::uint64_t used = 0;          // in which somebody was seen
  std::uint64_t nobody = 0;        // in which nobody was
  std::uint64_t unexplained = 0;   // by a person at one of the places
  std::uint64_t out_of_order = 0;  // not later than what had been seen
  std::uint64_t unusable = 0;      // in which no access point heard anything that can be used
  std::uint64_t passed_over = 0;   // frames between the moments

  PersonTrackerCounters& operator+=(const PersonTrackerCounters& other);
};

struct PersonUpdate {
  std::uint64_t track = 1;  // its number, never used again
  FilteredEstimate estimate;
};

class PersonTracker {
 public:
  PersonTracker(std::shared_ptr<const PersonLocalizer> localizer, PersonTrackerOptions options);

  // Appends an estimate for every moment of the burst in which there is a track. `frames`: of the
  // reference's transmitter, in order of time. `heard_since`: the transmitter has not been silent
  // since then, earlier bursts were left out; its first frame when nothing is stated.
  void hear(std::span<const CsiFrame> frames,
            std::vector<PersonUpdate>& updates,
            std::optional<Timestamp> heard_since = std::nullopt);

  // No frame before `now` comes any more: appends where somebody unseen may be, or that the track
  // is lost.
  void advance(Timestamp now, std::vector<PersonUpdate>& updates);

  // The track ends, for that reason: time may go back.
  void restart(const std::string& reason, std::vector<PersonUpdate>& updates);

  // Of the track, or of the next one where there is none.
  std::uint64_t number() const;
  std::optional<Timestamp> last_moment() const { return time_; }
  // When the person was seen clearly last; `now` without a track.
  Timestamp seen_until(Timestamp now) const { return life_ ? std::min(now, life_->clear) : now; }
  const PersonTrackerCounters& counters() const { return counters_; }

 private:
  enum class Sight : std::uint8_t { kSeen, kNobody, kUnexplained };
  // `least`: of PersonMap::somebody, for somebody to be there.
  static Sight sight_of(const PersonMap& map, double least);

  struct Life {
    GridFilter filter;
    std::uint64_t track = 0;
    Timestamp time{};  // of the filter
    Timestamp seen{};
    Timestamp clear{};    // last time that somebody was seen as clearly as a track needs to begin
    Timestamp weighed{};  // last moment that was
    Timestamp looked{};   // last moment that was compared with the whole room
    Timestamp due{};      // of the next predicted position, if the transmitter stays silent
    TrackState state = TrackState::kTentative;
    std::size_t moments = 0;  // in which somebody was seen
    double credit = 0.0;      // of a snapshot's weight, given to the present channel
    bool is_clear = true;     // what the present channel shows
    std::vector<PersonObservation::Array> last{};
    KnownCells within{};  // where in the best cells, of the last moment that was weighed
  };

  void hear_moment(std::span<const CsiFrame> frames, std::vector<PersonUpdate>& updates);
  void coast(Timestamp until, std::vector<PersonUpdate>& updates);
  void begin(Timestamp time);
  void predict(Timestamp time);
  double change_of(const PersonObservation& observation) const;
  PersonMap look(const PersonObservation& observation);
  PersonMap map(const PersonObservation& observation, const LookedCells& looked) const;
  void learn(const PersonMap& map, double weight);
  Sight weigh(const PersonObservation& observation);
  std::optional<TrackTransition> age(Timestamp time, bool is_seen);
  LocationEstimate unheard(Timestamp time) const;
  void report(LocationEstimate location,
              bool is_seen,
              std::optional<TrackTransition> transition,
              std::vector<PersonUpdate>& updates);

  std::shared_ptr<const PersonLocalizer> localizer_;
  PersonTrackerOptions options_;
  std::shared_ptr<const FreeSpace> space_;
  std::optional<Life> life_;
  std::optional<Timestamp> time_;  // of the last moment
  std::uint64_t numbers_ = 0;      // that were used up
  PersonTrackerCounters counters_;
};

}  // namespace rayloc
