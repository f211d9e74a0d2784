// ObservedArray: a burst in the coordinates of DelayBasis at every delay of a search, for the
// comparison with a place, eight delays at a time.
//
// A likelihood is evaluated at every fourth delay first (`coarse`), then in the windows of eight
// delays around promising ones.
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/likelihood/lane_kernel.h"

namespace rayloc {

struct ObservedArray {
  static constexpr std::size_t kStride = 4;            // from one coarse delay to the next
  static constexpr std::size_t kWindows = kLaneCount;  // a count: a coarse delay for each lane
  static constexpr std::size_t kDelays = kStride * kWindows;  // a count
  static constexpr double kDelayStep = 1.5e-9;                // [s], from one delay to the next
  static constexpr double kEarliest = -12e-9;  // [s], of the strongest echo after the first ray
  using Row = LaneRow;
  struct Block {
    std::vector<Row> re;  // [coordinate][delay]
    std::vector<Row> im;
  };
  Block coarse;                         // entry i: delay 4 i + 2
  std::array<Block, kWindows> windows;  // of entry i: eight delays, from first_of(i) on
  double captured = 0.0;                // largest share of the power inside the basis
  double noise = 0.0;                   // noise of the burst, as ModelError::noise; 0: negligible

  explicit ObservedArray(std::size_t coordinates = 0);

  std::size_t coordinates() const { return coarse.re.size(); }
  // The first delay of a window: its coarse delay is the fourth, or the third and the seventh at
  // the ends of the search.
  static std::size_t first_of(std::size_t window) {
    const std::size_t coarse = kStride * window + kStride / 2;
    return std::min(coarse - std::min<std::size_t>(coarse, 3), kDelays - kLaneCount);
  }
  // A bit for each window about a coarse delay that may hold the best of all delays. values:
  // log-likelihoods of the coarse delays.
  static std::uint8_t peak_windows(const Row& values);
  void set(std::size_t coordinate, std::size_t delay, std::complex<double> value);
  // All delays of a coordinate.
  void set(std::size_t coordinate,
           std::span<const float, kDelays> re,
           std::span<const float, kDelays> im);
  std::complex<double> value(std::size_t coordinate, std::size_t delay) const;
};

}  // namespace rayloc
