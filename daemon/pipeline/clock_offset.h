// ClockOffset: how much later the machine's clock is than event time
// (capture/source/event_clock.h): zero until somebody sets the clock. What is published is told by
// the clock as it is now.
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
