// FrameSeries: the frames of one link, resampled in equal steps of time.
//
// Frames arrive at irregular times and some are lost. Samples are interpolated between two frames
// that are at most kMaxBridged steps apart; a longer gap ends the series. A retry is a sample like
// any other: it was sent at its own time through the channel of that time.
#pragma once

#include <complex>
#include <deque>
#include <optional>
#include <vector>

#include "engine/base/timestamp.h"

namespace rayloc {

inline constexpr double kMaxBridged = 4.5;  // [steps], from frame to frame: three are lost

class FrameSeries {
 public:
  // False if the series ended before this frame: a gap. REQUIRES: times never decrease.
  bool add(Timestamp time, std::vector<std::complex<double>> values);

  // Frames per second, from the median of their distances; 0 for fewer than three frames.
  double rate() const;
  std::optional<Timestamp> first() const;
  std::optional<Timestamp> last() const;

  // The values at `time`, interpolated; empty outside the received interval.
  std::optional<std::vector<std::complex<double>>> at(Timestamp time) const;
  // Removes the values that are not needed for `time` and later.
  void forget_before(Timestamp time);
  void clear() { frames_.clear(); }

 private:
  struct Frame {
    Timestamp time;
    std::vector<std::complex<double>> values;
  };

  std::deque<Frame> frames_;
};

}  // namespace rayloc
