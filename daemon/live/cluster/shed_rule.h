// Rule by which a site leaves out received data while the load exceeds its processing capacity.
//
// Whole windows of event time are left out: the remaining windows are long enough
// for bursts, and their choice is a function of the level and of time alone.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "engine/base/timestamp.h"

namespace rayloc {

inline constexpr std::uint32_t kMaxShed = 3;  // an eighth is used

// Returns true for the first of every 2^level windows of 400 ms.
bool is_used(Timestamp time, std::uint32_t level);

class ShedRule {
 public:
  using Time = std::chrono::steady_clock::time_point;
  struct Limits {
    // Lag in event time between reception and explanation: above the upper limit for
    // that period, more is left out; below the lower limit for that period, less is.
    Duration most_lag = std::chrono::seconds(3);
    Duration least_lag = std::chrono::milliseconds(500);
    Duration patience = std::chrono::seconds(5);
  };

  explicit ShedRule(const Limits& limits) : limits_(limits) {}

  // Returns the new level, if it differs from `level`. `received`: end of the received
  // data; `done`: end of the explained data; both are unset before their first value.
  std::optional<std::uint32_t> next_level(Timestamp received,
                                          Timestamp done,
                                          std::uint32_t level,
                                          Time now);

 private:
  enum class Load : std::uint8_t { kUsual, kTooMuch, kLittle };

  const Limits limits_;
  Load load_ = Load::kUsual;
  Time since_{};  // of that load, or of the last change
};

}  // namespace rayloc
