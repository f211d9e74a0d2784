#include "daemon/pipeline/burst_queue.h"

#include <algorithm>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

std::uint64_t frames_of(const Burst& burst) { return burst.frames.size() + burst.surplus; }

}  // namespace

void BurstQueue::push(std::vector<Burst>& ended) {
  for (Burst& burst : ended) {
    frames_ += frames_of(burst);
    const auto place = place_.find(burst.transmitter);
    if (place == place_.end()) {
      const auto added = waiting_.insert(waiting_.end(), std::move(burst));
      if (overflow_ == Overflow::kDropOldest) {
        place_.emplace(added->transmitter, added);
      }
      continue;
    }
    Burst& older = *place->second;
    const std::uint64_t given_up = frames_of(older);
    frames_ -= given_up;
    merged_frames_ += given_up;
    ++merged_bursts_;
    burst.heard_since = older.heard_since;
    older = std::move(burst);
  }
  ended.clear();
}

Burst BurstQueue::pop() {
  RAYLOC_CHECK(!waiting_.empty());
  Burst burst = std::move(waiting_.front());
  place_.erase(burst.transmitter);
  waiting_.pop_front();
  frames_ -= frames_of(burst);
  return burst;
}

Timestamp BurstQueue::earliest(Timestamp time) const {
  for (const Burst& burst : waiting_) {
    time = std::min(time, burst.first);
  }
  return time;
}

}  // namespace rayloc
