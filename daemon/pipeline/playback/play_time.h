// PlayTime: how long recordings take to be played at speed 1, without what nobody waits for: where
// none of them holds anything for longer than `max_gap`, what is longer is skipped.
#pragma once

#include <vector>

#include "capture/source/record_times.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class PlayTime {
 public:
  // `busy`: when something was recorded, in order and apart. REQUIRES: not empty.
  PlayTime(const std::vector<TimeSpan>& busy, Duration max_gap);

  Timestamp begin() const { return begin_; }
  Timestamp end() const { return end_; }
  Duration length() const { return played(end_); }
  // From the beginning to that time.
  Duration played(Timestamp time) const;
  // When that is reached: what is skipped has been then.
  Timestamp recorded(Duration played) const;

  // In order. At most kMostSkipped, the longest.
  static constexpr std::size_t kMostSkipped = 256;
  const std::vector<TimeSpan>& skipped() const { return skipped_; }

 private:
  Timestamp begin_;
  Timestamp end_;
  std::vector<TimeSpan> skipped_;
};

}  // namespace rayloc
