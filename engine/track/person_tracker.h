// PersonTracker: tracks one person without a device through time (METHODS B5, B6), from the
// likelihoods that bursts of fixed transmitters give for every cell of the room.
//
//   (none) --seen--> tentative --seen often enough--> confirmed --not seen--> coasting --> lost
//
// The filter is that of devices (grid_filter.h). A burst is not assigned to a person: a track
// begins when a person is seen, and a second person is not distinguished from the first.
//
// A person who is no longer seen is predicted at every moment with frames and, while the
// transmitter is silent, at fixed times after the last moment: the output does not depend on how
// often advance() is called.
//
// Thread safety: use from one thread only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/grid/cell_mass.h"
#include "engine/person/person_localizer.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"
#include "engine/track/searched_cells.h"
#include "engine/track/track.h"

namespace rayloc {

struct PersonTrackerOptions {
  // People walk at up to 1.4 m/s, and obstacles make them turn.
  MotionModel motion{.walking_speeds = {0.7, 1.4}, .direction_time = 0.5};
  // Frames of all access points within this interval are one measurement: the phase of an echo past
  // a walker changes by half a cycle in 12 ms, so frames of one access point are not averaged.
  Duration moment = std::chrono::milliseconds(10);
  // Time between evaluated moments. Frames in between add little information on the position.
  Duration interval = std::chrono::milliseconds(80);
  // Correlation time of the model error along a walk: the moments within it together weigh as much
  // as one snapshot.
  Duration evidence_time = std::chrono::milliseconds(250);
  // The same for a body that is not round (PersonModel::front_offset_sigma) and one access point:
  // the error persists while the body keeps its direction. Several access points see other sides.
  Duration one_sided_evidence_time = std::chrono::milliseconds(500);
  // Share by which the person's contribution must change to count as new evidence; 1: the whole
  // contribution. Shadows change slowly and are most of the contribution.
  double moved_change = 0.03;
  std::size_t confirming_moments = 5;
  Duration coast_after = std::chrono::milliseconds(500);  // unseen, a track coasts
  Duration forget_after = std::chrono::seconds(1);        // unseen, a tentative track is lost
  Duration lose_after = std::chrono::seconds(5);          // unseen, any track is lost
  // Time without a clear detection after which any track is lost: a weak link receives as much from
  // an empty room as from a person, so the track of a person who left would never end.
  Duration unclear_after = std::chrono::seconds(10);
  // Compares every moment with the whole room: the reference for the restricted search.
  bool is_exhaustive = false;
  // Time between two predicted positions while the transmitter is silent.
  Duration coasting_interval = std::chrono::milliseconds(200);
  // Tracks are numbered first_number, first_number + number_step, ...: trackers of several
  // transmitters never use the same number, whichever detects a person first.
  std::uint64_t first_number = 1;
  std::uint64_t number_step = 1;
  // Before this time another tracker assigns the numbers, the next one being first_number: a person
  // who is lost earlier returns the number.
  Timestamp numbered_before = Timestamp::min();
  // The last moment that the other tracker evaluated: the next is `interval` later.
  std::optional<Timestamp> last_moment = std::nullopt;
};

// moments = used + `no_person` + unexplained + out_of_order + unusable; begun = lost + tracks now.
struct PersonTrackerCounters {
  std::uint64_t begun = 0;         // tracks
  std::uint64_t lost = 0;          // tracks
  std::uint64_t moments = 0;       // measurements
  std::uint64_t used = 0;          // with a detected person
  std::uint64_t no_person = 0;     // without a detected person
  std::uint64_t unexplained = 0;   // not explained by a person at any position
  std::uint64_t out_of_order = 0;  // not later than the last moment
  std::uint64_t unusable = 0;      // without usable frames of any access point
  std::uint64_t passed_over = 0;   // frames between the evaluated moments

  PersonTrackerCounters& operator+=(const PersonTrackerCounters& other);
};

struct PersonUpdate {
  std::uint64_t track = 1;  // number of the track, never used again
  FilteredEstimate estimate;
};

class PersonTracker {
 public:
  PersonTracker(std::shared_ptr<const PersonLocalizer> localizer, PersonTrackerOptions options);

  // Appends an estimate for every moment of the burst in which there is a track. `frames`: from the
  // reference's transmitter, in order of time. `received_since`: the transmitter has not been
  // silent since this time although earlier bursts were left out; without a value, its first frame.
  void receive(std::span<const CsiFrame> frames,
               std::vector<PersonUpdate>& updates,
               std::optional<Timestamp> received_since = std::nullopt);

  // No frame before `now` will arrive: appends predicted positions of an unseen person, or the loss
  // of the track.
  void advance(Timestamp now, std::vector<PersonUpdate>& updates);

  // Ends the track with this reason, since time may go back.
  void restart(const std::string& reason, std::vector<PersonUpdate>& updates);

  // Number of the track, or of the next one if there is none.
  std::uint64_t number() const;
  std::optional<Timestamp> last_moment() const { return time_; }
  // Time of the last clear detection; `now` without a track.
  Timestamp seen_until(Timestamp now) const { return life_ ? std::min(now, life_->clear) : now; }
  const PersonTrackerCounters& counters() const { return counters_; }

 private:
  enum class Sight : std::uint8_t { kSeen, kNoPerson, kUnexplained };
  // `least`: least value of `PersonMap::presence` at which a person is reported.
  static Sight sight_of(const PersonMap& map, double least);

  struct Life {
    GridFilter filter;
    std::uint64_t track = 0;
    Timestamp time{};  // time of the filter
    Timestamp seen{};
    Timestamp clear{};     // last time that a person was seen as clearly as a track needs to begin
    Timestamp weighed{};   // last moment that was weighed
    Timestamp searched{};  // last moment that was compared with the whole room
    Timestamp due{};       // time of the next predicted position, if the transmitter stays silent
    TrackState state = TrackState::kTentative;
    std::size_t moments = 0;  // number of moments with a detected person
    double credit = 0.0;      // share of a snapshot's weight already given to the present channel
    bool is_clear = true;     // a clear detection in the present channel
    std::vector<PersonObservation::Array> last{};
    RefinedCells within{};  // distribution inside the best cells, from the last weighed moment
  };

  void receive_moment(std::span<const CsiFrame> frames, std::vector<PersonUpdate>& updates);
  void coast(Timestamp until, std::vector<PersonUpdate>& updates);
  void begin(Timestamp time);
  void predict(Timestamp time);
  // Since the remembered arrays.
  struct Change {
    double share = 1.0;    // of the person's contribution: 0 none, 1 as by a move
    bool is_rest = false;  // noise and the radio explain it, and would not hide a move
  };
  Change change_of(const PersonObservation& observation) const;
  PersonMap evaluate(const PersonObservation& observation);
  PersonMap map(const PersonObservation& observation, const SearchedCells& searched) const;
  void learn(const PersonMap& map, double weight);
  Sight weigh(const PersonObservation& observation);
  std::optional<TrackTransition> age(Timestamp time, bool is_seen);
  LocationEstimate estimate_without_burst(Timestamp time) const;
  void report(LocationEstimate location,
              bool is_seen,
              std::optional<TrackTransition> transition,
              std::vector<PersonUpdate>& updates);

  std::shared_ptr<const PersonLocalizer> localizer_;
  PersonTrackerOptions options_;
  std::shared_ptr<const FreeSpace> space_;
  std::optional<Life> life_;
  std::optional<Timestamp> time_;  // time of the last moment
  std::uint64_t numbers_ = 0;      // count of numbers that were used up
  PersonTrackerCounters counters_;
};

}  // namespace rayloc
