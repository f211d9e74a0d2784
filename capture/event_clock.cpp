#include "capture/event_clock.h"

#include <algorithm>
#include <ctime>

namespace rayloc {
namespace {

// Two readings of the clocks may be this much apart because the thread was interrupted between
// them. A smaller step is absorbed by the watermark.
constexpr Duration kReadingJitter = std::chrono::milliseconds(1);

Duration read_clock(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + Duration(now.tv_nsec);
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
    correction_ = std::max(Duration::zero(), correction_ - step);
  }
  observed_ = realtime + correction_;
}

void EventClock::observe_now() {
  // The narrowest of a few readings: an interruption between the two looks like a step.
  Duration monotonic{};
  Duration realtime{};
  for (int attempt = 0; attempt < 3; ++attempt) {
    const Duration before = read_clock(CLOCK_MONOTONIC);
    realtime = read_clock(CLOCK_REALTIME);
    monotonic = read_clock(CLOCK_MONOTONIC);
    if (monotonic - before < kReadingJitter / 2) {
      break;
    }
  }
  observe(Timestamp(realtime), monotonic);
}

Timestamp EventClock::event_time(Timestamp stamp) const {
  return std::max(to_microseconds(stamp + correction_), watermark_);
}

void EventClock::drained() { advance(observed_ - kQueueing); }

void EventClock::not_drained(Timestamp last) { advance(last - kQueueing); }

void EventClock::advance(Timestamp time) {
  watermark_ = std::max(watermark_, to_microseconds(time));
}

}  // namespace rayloc
