// Playback: the one clock of all recordings that a daemon runs on, and where people hold it: they
// pause it, change its speed and move it to another place of the recordings.
//
// Sources (PlaybackSource) ask it what is due. A move is a new Place, which each of them goes to by
// itself: it begins a little (`lead_in`) before the position asked for, so that the estimates of
// that position are there at once, paused or not.
//
// Where the recordings hold nothing for longer than `max_gap`, it jumps over what is longer.
//
// The clock never runs away from a source that gives its datagrams later than they are due, because
// the estimator has not kept up: it is set back. So what is paused stands still.
//
// Thread safety: all members from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "capture/source/record_times.h"
#include "daemon/pipeline/playback/play_time.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class Playback {
 public:
  using Clock = std::chrono::steady_clock;

  struct Options {
    // When any of the recordings holds something (busy_times()), from the first datagram to the
    // last. REQUIRES: not empty.
    std::vector<TimeSpan> busy = {};
    std::optional<double> speed =
        1.0;  // recorded seconds per second, > 0; nothing: as fast as it goes
    Duration lead_in = std::chrono::milliseconds(700);
    Duration max_gap = kMaxGap;  // the longest that is waited where there is nothing
    std::function<Clock::time_point()> now = [] { return Clock::now(); };
  };
  explicit Playback(Options options);

  // ---- For people.
  enum class Running : std::uint8_t { kPlaying, kPaused, kEnded };
  struct State {
    Running running = Running::kPlaying;
    Timestamp begin;
    Timestamp end;
    Timestamp position;
    std::optional<double> speed;
    std::uint64_t moves = 0;
    std::vector<TimeSpan> skipped = {};  // what is not waited for, in order
  };
  State state() const;

  // What is to change; the rest stays. REQUIRES: speed > 0.
  struct Change {
    std::optional<bool> play = {};  // at the end: from the beginning on
    std::optional<std::optional<double>> speed = {};
    std::optional<Timestamp> position = {};  // brought between begin and end
  };
  // The state after it.
  State change(const Change& change);

  // ---- For sources.
  struct Place {
    std::uint64_t number = 0;           // of the move; 0: the beginning
    Timestamp from = Timestamp::min();  // nothing earlier is given
  };
  Place place() const;

  // Waits until a datagram of that time is due, the place is no longer the `number`th, or until
  // `deadline`. Returns up to which time datagrams are due; Timestamp::min() at another place.
  Timestamp wait_for(Timestamp next, std::uint64_t number, Clock::time_point deadline);

  // Waits until the place is no longer the `number`th, or until `deadline`.
  void wait_at_end(std::uint64_t number, Clock::time_point deadline);

  // A datagram of that time was given out.
  void given(Timestamp time, std::uint64_t number);

 private:
  Timestamp position() const;
  Timestamp due() const;
  std::optional<Clock::time_point> when(Timestamp time) const;
  void anchor(Timestamp position);
  void keep_step(Timestamp next);

  const Options options_;
  const PlayTime time_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // All guarded by mutex_.
  std::optional<double> speed_;
  bool playing_ = true;
  bool started_ = false;        // a source has asked
  Timestamp anchor_;            // was the position ...
  Clock::time_point anchored_;  // ... at this instant
  Timestamp given_;             // the latest since the last move
  Place place_;
};

}  // namespace rayloc
