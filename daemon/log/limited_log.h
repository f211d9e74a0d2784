// LimitedLog: what can happen thousands of times a second, said at once and then once every 30 s
// with how often it happened meanwhile.
//
//   LimitedLog log(log_event);
//   log.say("denied", {LogLevel::kWarning, "a client was turned away", {{"address", "10.0.0.7"}}});
//
// Reads no clock by itself: times are passed, or those of steady_clock. Thread safety: any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "daemon/log/log.h"

namespace rayloc {

class LimitedLog {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Write = std::function<void(const LogEvent& event)>;

  explicit LimitedLog(Write write, std::chrono::seconds period = std::chrono::seconds(30))
      : write_(std::move(write)), period_(period) {}

  // `site`: what is counted together, "denied", "kernel_drops ap1". `times`: that it happened.
  void say(const std::string& site,
           LogEvent event,
           std::uint64_t times = 1,
           Time now = std::chrono::steady_clock::now());
  // Says what was held back and is due, even when nothing follows; to be called now and then.
  void flush(Time now = std::chrono::steady_clock::now());
  // Says all that was held back, due or not: what is said when nothing will follow.
  void finish();

 private:
  struct Site {
    Time said;
    std::uint64_t held_back = 0;
    LogEvent latest;
  };
  void write(Site& site, Time now);

  const Write write_;
  const std::chrono::seconds period_;
  std::mutex mutex_;
  std::map<std::string, Site> sites_;  // guarded by mutex_
};

}  // namespace rayloc
