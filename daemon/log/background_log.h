// BackgroundLog: writes the log on a thread of its own, so that a journal or a terminal that takes
// nothing holds up nobody who logs: not the main thread, which feeds the watchdog, nor the
// pipeline.
//
// What waits is bounded; past that the oldest entry gives way and is counted. A writer that does
// not come back is left behind when the log ends. Thread safety: any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <spdlog/common.h>

#include "daemon/log/log.h"

namespace rayloc {

struct LogEntry {
  spdlog::level::level_enum level = spdlog::level::info;
  std::chrono::system_clock::time_point time;
  std::string message;
  std::vector<LogField> fields = {};
};

class BackgroundLog {
 public:
  using Write = std::function<void(const LogEntry& entry)>;
  static constexpr std::size_t kWaiting = 8192;
  static constexpr std::chrono::milliseconds kPatience{1000};

  // `write`: called on the thread, one entry after another; what it throws is dropped.
  explicit BackgroundLog(Write write,
                         std::size_t max_waiting = kWaiting,
                         std::chrono::milliseconds patience = kPatience);
  // Waits until everything is written, as flush() does.
  ~BackgroundLog();
  BackgroundLog(const BackgroundLog&) = delete;
  BackgroundLog& operator=(const BackgroundLog&) = delete;

  void put(LogEntry entry);
  // Waits until everything that was put before is written, for `patience` at most; whether it is.
  bool flush() const;
  // Entries that gave way to newer ones.
  std::uint64_t dropped() const;

 private:
  struct Shared;
  static void run(const std::shared_ptr<Shared>& shared);

  const std::chrono::milliseconds patience_;
  const std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this
  std::thread thread_;
};

}  // namespace rayloc
