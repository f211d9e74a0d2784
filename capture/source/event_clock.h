// EventClock: turns the kernel's time stamps into event times that go on evenly, whatever is done
// to the machine's clock: nobody's track may end because the clock was set.
//
// CLOCK_REALTIME - CLOCK_MONOTONIC changes only when the clock is set, never when it is slewed.
// Event time is the machine's clock when the process first looked, and what has passed since: the
// same for all sources of a process. ahead() says how much later the clock is by now, for whoever
// tells people times.
#pragma once

#include <cstdint>

#include "engine/base/timestamp.h"

namespace rayloc {

class EventClock {
 public:
  // How much later than its stamp a datagram may become readable: the kernel stamps it first and
  // queues it then, and other work of the same processor may come in between.
  static constexpr Duration kQueueing = std::chrono::milliseconds(2);

  explicit EventClock(Duration queueing = kQueueing) : queueing_(queueing) {}

  // The clocks, read just before the socket is.
  void observe(Timestamp realtime, Duration monotonic);
  void observe_now();

  // Of a datagram stamped by the kernel: truncated to microseconds, never before the watermark, nor
  // far ahead of the last observe() (the clock may have been set since).
  Timestamp event_time(Timestamp stamp) const;

  // The socket was found empty after observe(): everything stamped before has been delivered.
  void drained();
  // More may be waiting; `last` is the event time of the last datagram delivered.
  void not_drained(Timestamp last);

  // No event time given from now on will be before this. In whole microseconds.
  Timestamp watermark() const { return watermark_; }
  // How often the clock was set.
  std::uint64_t steps() const { return steps_; }
  // The machine's clock less event time: what it was set by in all.
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
