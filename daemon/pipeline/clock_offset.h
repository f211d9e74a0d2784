// ClockOffset: the difference of the machine's clock and event time (capture/source/event_clock.h):
// zero until the clock is set. Published times are those of the machine's clock at the time of
// publication.
//
// Thread safety: any thread.
#pragma once

#include <mutex>

#include "capture/source/event_clock.h"

namespace rayloc {

class ClockOffset {
 public:
  Duration now() {
    const std::lock_guard lock(mutex_);
    clock_.observe_now();
    return clock_.ahead();
  }

 private:
  std::mutex mutex_;
  EventClock clock_;  // guarded by mutex_
};

}  // namespace rayloc
