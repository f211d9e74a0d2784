// Playback: the one clock of all recordings that a daemon runs on, and its user control: pause,
// speed, and seeks to another position of the recordings.
//
// Sources (PlaybackSource) read from it which datagrams are due. A seek creates a new Place, and
// each source moves there by itself: it begins slightly (`lead_in`) before the requested position,
// so that the estimates of that position are available immediately, paused or not.
//
// Where the recordings contain no data for longer than `max_gap`, it skips the excess.
//
// The clock never runs ahead of a source that gives its datagrams later than they are due because
// the estimator is behind: it is set back. A paused recording therefore does not advance.
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
    // Spans in which any of the recordings contains data (busy_times()), from the first datagram to
    // the last. REQUIRES: not empty.
    std::vector<TimeSpan> busy = {};
    std::optional<double> speed = 1.0;  // recorded seconds per second, > 0; empty: at maximum speed
    Duration lead_in = std::chrono::milliseconds(700);
    Duration max_gap = kMaxGap;  // maximum wait where there are no data
    std::function<Clock::time_point()> now = [] { return Clock::now(); };
  };
  explicit Playback(Options options);

  // ---- User control.
  enum class Running : std::uint8_t { kPlaying, kPaused, kEnded };
  struct State {
    Running running = Running::kPlaying;
    Timestamp begin;
    Timestamp end;
    Timestamp position;
    std::optional<double> speed;
    std::uint64_t moves = 0;
    std::vector<TimeSpan> skipped = {};  // spans that playback skips, in order
  };
  State state() const;

  // Requested changes; the rest stays. REQUIRES: speed > 0.
  struct Change {
    std::optional<bool> play = {};  // at the end: restarts from the beginning
    std::optional<std::optional<double>> speed = {};
    std::optional<Timestamp> position = {};  // clamped to begin and end
  };
  // Returns the state after the change.
  State change(const Change& change);

  // ---- Interface of sources.
  struct Place {
    std::uint64_t number = 0;           // of the seek; 0: the beginning
    Timestamp from = Timestamp::min();  // no earlier datagram is given out
  };
  Place place() const;

  // Waits until a datagram of that time is due, the place is no longer the `number`th, or until
  // `deadline`. Returns the time up to which datagrams are due; Timestamp::min() at another place.
  Timestamp wait_for(Timestamp next, std::uint64_t number, Clock::time_point deadline);

  // Waits until the place is no longer the `number`th, or until `deadline`.
  void wait_at_end(std::uint64_t number, Clock::time_point deadline);

  // Reports that a datagram of that time was given out.
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
  bool started_ = false;        // a source has called
  Timestamp anchor_;            // was the position ...
  Clock::time_point anchored_;  // ... at this instant
  Timestamp given_;             // latest since the last seek
  Place place_;
};

}  // namespace rayloc
