// What a site leaves out of what it hears while there is more than can be explained, and when.
//
// Whole windows of event time are left out: what is used is enough for bursts, and which are is a
// function of the level and of time alone.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "engine/base/timestamp.h"

namespace rayloc {

inline constexpr std::uint32_t kMostShed = 3;  // an eighth is used

// Of 2^level windows of 400 ms the first is used.
bool is_used(Timestamp time, std::uint32_t level);

class ShedRule {
 public:
  using Time = std::chrono::steady_clock::time_point;
  struct Limits {
    // Of event time, between what was heard and what is explained: more of it for so long, and more
    // is left out; less of it for so long, and less is.
    Duration most_lag = std::chrono::seconds(3);
    Duration least_lag = std::chrono::milliseconds(500);
    Duration patience = std::chrono::seconds(5);
  };

  explicit ShedRule(const Limits& limits) : limits_(limits) {}

  // The level that is to be, where it is another one than `level`. `heard`: up to when; `done`: up
  // to when all is explained; neither is known before the first.
  std::optional<std::uint32_t> next_level(Timestamp heard,
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
