// PlayTime: the duration of recordings at speed 1 without long gaps: where none of them contains
// data for longer than `max_gap`, the excess is skipped.
#pragma once

#include <vector>

#include "capture/source/record_times.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class PlayTime {
 public:
  // `busy`: spans that contain data, in order and disjoint. REQUIRES: not empty.
  PlayTime(const std::vector<TimeSpan>& busy, Duration max_gap);

  Timestamp begin() const { return begin_; }
  Timestamp end() const { return end_; }
  Duration length() const { return played(end_); }
  // From the beginning to that time.
  Duration played(Timestamp time) const;
  // The time at which that is reached: after any skipped span.
  Timestamp recorded(Duration played) const;

  // In order. At most kMaxSkipped, the longest.
  static constexpr std::size_t kMaxSkipped = 256;
  const std::vector<TimeSpan>& skipped() const { return skipped_; }

 private:
  Timestamp begin_;
  Timestamp end_;
  std::vector<TimeSpan> skipped_;
};

}  // namespace rayloc
