// BackgroundLog: writes the log on a separate thread, so that a blocked journal or terminal
// delays no thread that logs: neither the main thread, which feeds the watchdog, nor the
// pipeline.
//
// The queue is bounded; beyond the limit the oldest entry is dropped and counted. A writer that
// does not return is abandoned when the log ends. Thread safety: any thread.
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

#include "daemon/live/log/log.h"

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

  // `write`: called on the thread, one entry after another; its exceptions are dropped.
  explicit BackgroundLog(Write write,
                         std::size_t max_waiting = kWaiting,
                         std::chrono::milliseconds patience = kPatience);
  // Waits until all entries are written, as flush() does.
  ~BackgroundLog();
  BackgroundLog(const BackgroundLog&) = delete;
  BackgroundLog& operator=(const BackgroundLog&) = delete;

  void put(LogEntry entry);
  // Waits at most `patience` until all earlier entries are written; returns true if they are.
  bool flush() const;
  // Entries that were dropped for newer ones.
  std::uint64_t dropped() const;

 private:
  struct Shared;
  static void run(const std::shared_ptr<Shared>& shared);

  const std::chrono::milliseconds patience_;
  const std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this
  std::thread thread_;
};

}  // namespace rayloc
