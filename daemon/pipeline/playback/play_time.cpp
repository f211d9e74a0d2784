#include "daemon/pipeline/playback/play_time.h"

#include <algorithm>

#include "engine/base/check.h"

namespace rayloc {

PlayTime::PlayTime(const std::vector<TimeSpan>& busy, Duration max_gap) {
  RAYLOC_CHECK(!busy.empty());
  begin_ = busy.front().begin;
  end_ = busy.back().end;
  for (std::size_t i = 1; i < busy.size(); ++i) {
    if (busy[i].begin - busy[i - 1].end > max_gap) {
      skipped_.push_back({busy[i - 1].end + max_gap, busy[i].begin});
    }
  }
  if (skipped_.size() > kMaxSkipped) {
    std::nth_element(
        skipped_.begin(),
        skipped_.begin() + kMaxSkipped,
        skipped_.end(),
        [](const TimeSpan& a, const TimeSpan& b) { return a.end - a.begin > b.end - b.begin; });
    skipped_.resize(kMaxSkipped);
    std::sort(skipped_.begin(), skipped_.end(), [](const TimeSpan& a, const TimeSpan& b) {
      return a.begin < b.begin;
    });
  }
}

Duration PlayTime::played(Timestamp time) const {
  Duration played = time - begin_;
  for (const TimeSpan& skip : skipped_) {
    if (skip.begin >= time) {
      break;
    }
    played -= std::min(time, skip.end) - skip.begin;
  }
  return played;
}

Timestamp PlayTime::recorded(Duration played) const {
  Timestamp time = begin_ + played;
  for (const TimeSpan& skip : skipped_) {
    if (skip.begin > time) {
      break;
    }
    time += skip.end - skip.begin;
  }
  return time;
}

}  // namespace rayloc
