#include "capture/source/event_clock.h"

#include <algorithm>
#include <ctime>

namespace rayloc {
namespace {

// Two readings of the clocks may be this much apart because the thread was interrupted between
// them. A smaller step is absorbed by the watermark.
constexpr Duration kReadingJitter = std::chrono::milliseconds(1);

// Maximum arrival delay of a datagram after the clock was read. A later stamp was made by a clock
// that was set after the reading.
constexpr Duration kMaxAhead = std::chrono::seconds(1);

Duration read_clock(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + Duration(now.tv_nsec);
}

struct Reading {
  Duration realtime{};
  Duration monotonic{};
  bool narrow = false;  // both read at one instant
};

// An interruption between the two clocks resembles a step: retries for a reading without one.
Reading read_clocks(int attempts) {
  Reading reading;
  for (int i = 0; i < attempts && !reading.narrow; ++i) {
    const Duration before = read_clock(CLOCK_MONOTONIC);
    reading.realtime = read_clock(CLOCK_REALTIME);
    reading.monotonic = read_clock(CLOCK_MONOTONIC);
    reading.narrow = reading.monotonic - before < kReadingJitter / 2;
  }
  return reading;
}

// CLOCK_REALTIME - CLOCK_MONOTONIC at the first call in this process: the sources of a process must
// agree on event time, whenever each of them began.
Duration offset_at_the_start() {
  constexpr int kAttempts = 1000;
  static const Reading kFirst = read_clocks(kAttempts);
  return kFirst.realtime - kFirst.monotonic;
}

Timestamp to_microseconds(Timestamp time) {
  return std::chrono::floor<std::chrono::microseconds>(time);
}

}  // namespace

void EventClock::observe(Timestamp realtime, Duration monotonic) {
  const Duration offset = realtime.time_since_epoch() - monotonic;
  if (!started_) {
    started_ = true;
    offset_ = offset;
  }
  const Duration step = offset - offset_;
  if (step > kReadingJitter || step < -kReadingJitter) {
    ++steps_;
    offset_ = offset;
    correction_ -= step;
  }
  observed_ = realtime + correction_;
}

void EventClock::observe_now() {
  if (!started_) {
    started_ = true;
    offset_ = offset_at_the_start();
  }
  constexpr int kAttempts = 3;
  const Reading now = read_clocks(kAttempts);
  // A step cannot be detected then; the next reading decides.
  observe(Timestamp(now.narrow ? now.realtime : now.monotonic + offset_), now.monotonic);
}

Timestamp EventClock::event_time(Timestamp stamp) const {
  const Timestamp time = stamp + correction_;
  const bool unseen_step = started_ && time > observed_ + kMaxAhead;
  return std::max(to_microseconds(unseen_step ? observed_ : time), watermark_);
}

void EventClock::drained() { advance(observed_ - queueing_); }

void EventClock::not_drained(Timestamp last) { advance(last - queueing_); }

void EventClock::advance(Timestamp time) {
  watermark_ = std::max(watermark_, to_microseconds(time));
}

}  // namespace rayloc
