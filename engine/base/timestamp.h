// Event time: UTC in integer nanoseconds. It is never a double since the epoch and never read from
// a clock inside the engine: time is passed in, so that a replay gives the results of the live run.
#pragma once

#include <chrono>

namespace rayloc {

using Duration = std::chrono::nanoseconds;
using Timestamp = std::chrono::sys_time<Duration>;

// Seconds of a duration, for formulas and for people.
constexpr double to_seconds(Duration d) { return std::chrono::duration<double>(d).count(); }

// The nearest nanosecond to `seconds`.
constexpr Duration from_seconds(double seconds) {
  return Duration(static_cast<Duration::rep>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5)));
}

}  // namespace rayloc
