// FrameSeries: what one access point hears of one transmitter as samples in equal steps of time.
//
// Frames come when they come and some are lost. Between two that are at most kMostBridged steps
// apart samples are interpolated; a longer gap ends the series. A retry is a
// sample as any other: it was sent at its own time through the channel of that time.
#pragma once

#include <complex>
#include <deque>
#include <optional>
#include <vector>

#include "engine/base/timestamp.h"

namespace rayloc {

inline constexpr double kMostBridged = 4.5;  // [steps], from frame to frame: three are lost

class FrameSeries {
 public:
  // False where the series ended before this frame: a gap. REQUIRES: times never decrease.
  bool add(Timestamp time, std::vector<std::complex<double>> values);

  // Frames in a second, from the median of their distances; 0 of fewer than three frames.
  double rate() const;
  std::optional<Timestamp> first() const;
  std::optional<Timestamp> last() const;

  // The values at `time`, interpolated; nothing outside of what was heard.
  std::optional<std::vector<std::complex<double>>> at(Timestamp time) const;
  // Keeps nothing that is not needed for `time` and later.
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
