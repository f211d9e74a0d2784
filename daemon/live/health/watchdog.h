// Watchdog: checks that every stage makes progress, and names those that do not.
//
//   Watchdog watchdog(stages, patience);
//   if (watchdog.check(now).empty()) { ... WATCHDOG=1 ... }
//
// A stage is stuck when it has neither called beat() nor rested for `patience`. Reads no clock.
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "daemon/pipeline/stage_progress.h"

namespace rayloc {

class Watchdog {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Watchdog(std::vector<Stage> stages, std::chrono::milliseconds patience);

  // Checks these stages from now on. One that was checked before, with equal name and progress,
  // keeps the time of its last progress.
  void replace(std::vector<Stage> stages);

  struct Stuck {
    std::string stage;
    std::chrono::milliseconds since{};  // since its last progress
  };
  // The currently stuck stages; to be called several times within `patience`.
  std::vector<Stuck> check(Time now);

 private:
  struct Seen {
    Stage stage;
    std::uint64_t beats = 0;
    std::optional<Time> advanced;  // nothing: not checked yet
  };
  std::vector<Seen> seen_;
  const std::chrono::milliseconds patience_;
};

}  // namespace rayloc
