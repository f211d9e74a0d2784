#include "daemon/pipeline/burst_queue.h"

#include <algorithm>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

std::uint64_t frames_of(const Burst& burst) { return burst.frames.size() + burst.surplus; }

}  // namespace

BurstQueue::Place BurstQueue::place_of(const Burst& burst, std::uint64_t turn) const {
  if (options_.overflow == Overflow::kWait) {
    return {Rank::kListed, {}, turn};
  }
  const Rank rank = options_.rank(burst.transmitter);
  const bool stranger = rank == Rank::kOther;
  return {rank, stranger ? -burst.last.time_since_epoch() : Duration::zero(), turn};
}

void BurstQueue::add(Burst&& burst, std::uint64_t turn) {
  frames_ += frames_of(burst);
  const MacAddress transmitter = burst.transmitter;
  const Place place = place_of(burst, turn);
  const auto added = waiting_.emplace(place, std::move(burst)).first;
  if (options_.overflow == Overflow::kDropOldest) {
    place_.insert_or_assign(transmitter, added);
  }
}

// The newer one keeps the turn.
void BurstQueue::replace(Waiting::iterator older, Burst&& burst) {
  const std::uint64_t given_up = frames_of(older->second);
  const std::uint64_t turn = older->first.turn;
  frames_ -= given_up;
  merged_frames_ += given_up;
  ++merged_bursts_;
  burst.heard_since = older->second.heard_since;
  waiting_.erase(older);
  add(std::move(burst), turn);
}

BurstQueue::Waiting::iterator BurstQueue::drop(Waiting::iterator burst) {
  const std::uint64_t frames = frames_of(burst->second);
  frames_ -= frames;
  dropped_frames_ += frames;
  ++dropped_bursts_;
  place_.erase(burst->second.transmitter);
  return waiting_.erase(burst);
}

void BurstQueue::push(std::vector<Burst>& ended, Timestamp now) {
  for (Burst& burst : ended) {
    const auto place = place_.find(burst.transmitter);
    if (place == place_.end()) {
      add(std::move(burst), ++turns_);
    } else {
      replace(place->second, std::move(burst));
    }
  }
  ended.clear();
  if (options_.overflow == Overflow::kWait) {
    return;
  }
  for (auto burst = waiting_.begin(); burst != waiting_.end();) {
    burst = now - burst->second.last > options_.max_age ? drop(burst) : std::next(burst);
  }
  while (frames_ > options_.max_frames && waiting_.size() > 1) {
    drop(std::prev(waiting_.end()));
  }
}

Burst BurstQueue::pop() {
  RAYLOC_CHECK(!waiting_.empty());
  const auto first = waiting_.begin();
  Burst burst = std::move(first->second);
  place_.erase(burst.transmitter);
  waiting_.erase(first);
  frames_ -= frames_of(burst);
  return burst;
}

Timestamp BurstQueue::earliest(Timestamp time) const {
  for (const auto& [place, burst] : waiting_) {
    time = std::min(time, burst.first);
  }
  return time;
}

}  // namespace rayloc
