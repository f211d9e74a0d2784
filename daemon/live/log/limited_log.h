// LimitedLog: logs events that may occur thousands of times a second: immediately, and then once
// every 30 s with their number meanwhile.
//
//   LimitedLog log(log_event);
//   log.add("denied", {LogLevel::kWarning, "a client was turned away", {{"address", "10.0.0.7"}}});
//
// Reads no clock by itself: times are passed, or those of steady_clock. Thread safety: any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "daemon/live/log/log.h"

namespace rayloc {

class LimitedLog {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Write = std::function<void(const LogEvent& event)>;

  explicit LimitedLog(Write write, std::chrono::seconds period = std::chrono::seconds(30))
      : write_(std::move(write)), period_(period) {}

  // `site`: counter key, "denied", "kernel_drops ap1". `times`: number of occurrences.
  void add(const std::string& site,
           LogEvent event,
           std::uint64_t times = 1,
           Time now = std::chrono::steady_clock::now());
  // Logs held-back events that are due, without a new event; to be called periodically.
  void flush(Time now = std::chrono::steady_clock::now());
  // Logs all held-back events, due or not: for the end of the log.
  void finish();

 private:
  struct Site {
    Time logged;
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
