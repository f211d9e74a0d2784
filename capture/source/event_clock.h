// EventClock: converts the kernel's time stamps to event times that advance evenly when the
// machine's clock is set: a clock step must not end any track.
//
// CLOCK_REALTIME - CLOCK_MONOTONIC changes only when the clock is set, never when it is slewed.
// Event time is the machine's clock at the first reading of the process plus the elapsed time: the
// same for all sources of a process. ahead() returns how much later the clock is now, for output of
// times to people.
#pragma once

#include <cstdint>

#include "engine/base/timestamp.h"

namespace rayloc {

class EventClock {
 public:
  // Maximum delay between a datagram's stamp and its readability: the kernel stamps it first and
  // queues it then, and other work of the same processor may come in between.
  static constexpr Duration kQueueing = std::chrono::milliseconds(2);

  explicit EventClock(Duration queueing = kQueueing) : queueing_(queueing) {}

  // Sets the clock readings taken just before the socket is read.
  void observe(Timestamp realtime, Duration monotonic);
  void observe_now();

  // Event time of a datagram stamped by the kernel: truncated to microseconds, never before the
  // watermark, nor far ahead of the last observe() (the clock may have been set since).
  Timestamp event_time(Timestamp stamp) const;

  // The socket was found empty after observe(): all datagrams stamped before are delivered.
  void drained();
  // More datagrams may wait; `last` is the event time of the last datagram delivered.
  void not_drained(Timestamp last);

  // Lower bound of all later event times. In whole microseconds.
  Timestamp watermark() const { return watermark_; }
  // Number of times the clock was set.
  std::uint64_t steps() const { return steps_; }
  // The machine's clock minus event time: the sum of all clock steps.
  Duration ahead() const { return -correction_; }

 private:
  void advance(Timestamp time);

  Duration queueing_;
  bool started_ = false;
  Duration offset_{};      // realtime - monotonic
  Duration correction_{};  // event time - realtime
  Timestamp observed_{};   // event time of the last observe()
  Timestamp watermark_ = Timestamp::min();
  std::uint64_t steps_ = 0;
};

}  // namespace rayloc
