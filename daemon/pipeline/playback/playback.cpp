#include "daemon/pipeline/playback/playback.h"

#include <algorithm>
#include <utility>

namespace rayloc {
namespace {

// Real time by which sources may be late before the clock waits for them.
constexpr double kLateness = 0.5;            // [s]
constexpr double kMaxPlaybackWait = 3600.0;  // [s] per wait; a gap may last years

Duration times(double seconds, double speed) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds * speed));
}

}  // namespace

Playback::Playback(Options options)
    : options_(std::move(options)),
      time_(options_.busy, options_.max_gap),
      speed_(options_.speed),
      anchor_(time_.begin()),
      anchored_(options_.now()),
      given_(time_.begin()) {}

// REQUIRES, as all private members: the mutex is held.
Timestamp Playback::position() const {
  if (!playing_ || !started_) {
    return anchor_;
  }
  if (!speed_) {
    return std::clamp(given_, anchor_, time_.end());
  }
  const std::chrono::duration<double> elapsed = options_.now() - anchored_;
  // In floating point: years of a clock that is never stopped do not overflow.
  const Duration from = time_.played(anchor_);
  if (elapsed.count() * *speed_ >= to_seconds(time_.length() - from)) {
    return time_.end();
  }
  const Duration played = times(elapsed.count(), *speed_);
  return played > Duration::zero() ? time_.recorded(from + played) : anchor_;
}

Timestamp Playback::due() const { return playing_ && !speed_ ? time_.end() : position(); }

// Empty: the time is not reached without a change.
std::optional<Playback::Clock::time_point> Playback::when(Timestamp time) const {
  if (!playing_ || !speed_) {
    return std::nullopt;
  }
  const Duration played = time_.played(time) - time_.played(anchor_);
  const double seconds = std::min(to_seconds(played) / *speed_, kMaxPlaybackWait);
  return anchored_ + std::chrono::ceil<Clock::duration>(std::chrono::duration<double>(seconds));
}

void Playback::anchor(Timestamp position) {
  anchor_ = std::clamp(position, time_.begin(), time_.end());
  anchored_ = options_.now();
}

void Playback::keep_step(Timestamp next) {
  if (!started_) {
    started_ = true;
    anchor(anchor_);
  }
  if (playing_ && speed_) {
    const Timestamp latest = time_.recorded(time_.played(next) + options_.lead_in +
                                            times(kLateness, std::max(1.0, *speed_)));
    if (position() > latest) {
      anchor(latest);
    }
  }
}

Playback::State Playback::state() const {
  const std::lock_guard lock(mutex_);
  const Timestamp now = position();
  return {now >= time_.end() ? Running::kEnded
          : playing_         ? Running::kPlaying
                             : Running::kPaused,
          time_.begin(),
          time_.end(),
          now,
          speed_,
          place_.number,
          time_.skipped()};
}

Playback::State Playback::change(const Change& change) {
  {
    const std::lock_guard lock(mutex_);
    const bool again = change.play.value_or(false) && position() >= time_.end();
    anchor(position());
    playing_ = change.play.value_or(playing_);
    speed_ = change.speed.value_or(speed_);
    if (change.position || again) {
      anchor(change.position.value_or(time_.begin()));
      given_ = anchor_;
      place_ = {place_.number + 1, anchor_ - options_.lead_in};
    }
  }
  changed_.notify_all();
  return state();
}

Playback::Place Playback::place() const {
  const std::lock_guard lock(mutex_);
  return place_;
}

Timestamp Playback::wait_for(Timestamp next, std::uint64_t number, Clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (place_.number != number) {
      return Timestamp::min();
    }
    keep_step(next);
    const Timestamp due_until = due();
    const auto now = options_.now();
    if (next <= due_until || now >= deadline) {
      return due_until;
    }
    changed_.wait_for(lock, std::min(deadline, when(next).value_or(deadline)) - now);
  }
}

void Playback::wait_at_end(std::uint64_t number, Clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, deadline - options_.now(), [&] { return place_.number != number; });
}

void Playback::given(Timestamp time, std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  if (place_.number == number) {
    given_ = std::max(given_, time);
  }
}

}  // namespace rayloc
