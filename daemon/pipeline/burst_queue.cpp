#include "daemon/pipeline/burst_queue.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// A rank leaves one in this many bursts to the ranks below it.
constexpr std::size_t kOneOf = 4;
constexpr auto kOther = static_cast<std::size_t>(Rank::kOther);

std::uint64_t frames_of(const Burst& burst) { return burst.frames.size() + burst.surplus; }

// Compares by the time of the last frames.
bool is_older(const std::pair<const std::uint64_t, Burst>& a,
              const std::pair<const std::uint64_t, Burst>& b) {
  return a.second.last < b.second.last;
}

}  // namespace

std::size_t BurstQueue::size() const {
  return std::accumulate(
      waiting_.begin(), waiting_.end(), std::size_t{0}, [](std::size_t sum, const Waiting& some) {
        return sum + some.size();
      });
}

void BurstQueue::add(Burst&& burst, std::uint64_t turn) {
  frames_ += frames_of(burst);
  const MacAddress transmitter = burst.transmitter;
  const bool live = options_.overflow == Overflow::kDropOldest;
  const auto rank = live ? static_cast<std::size_t>(options_.rank(transmitter)) : 0;
  const auto added = waiting_[rank].emplace(turn, std::move(burst)).first;
  if (live) {
    place_.insert_or_assign(transmitter, Place{rank, added});
  }
}

// The newer burst keeps the turn of the older.
void BurstQueue::replace(const Place& older, Burst&& burst) {
  const auto& [turn, before] = *older.burst;
  const std::uint64_t kept_turn = turn;
  const std::uint64_t given_up = frames_of(before);
  frames_ -= given_up;
  merged_frames_ += given_up;
  ++merged_bursts_;
  burst.received_since = before.received_since;
  waiting_[older.rank].erase(older.burst);
  add(std::move(burst), kept_turn);
}

void BurstQueue::drop(const Place& place) {
  const std::uint64_t frames = frames_of(place.burst->second);
  frames_ -= frames;
  dropped_frames_ += frames;
  ++dropped_bursts_;
  place_.erase(place.burst->second.transmitter);
  waiting_[place.rank].erase(place.burst);
}

void BurstQueue::push(std::vector<Burst>& ended, Timestamp now) {
  for (Burst& burst : ended) {
    const auto place = place_.find(burst.transmitter);
    if (place == place_.end()) {
      add(std::move(burst), ++turns_);
    } else {
      replace(Place(place->second), std::move(burst));
    }
  }
  ended.clear();
  if (options_.overflow == Overflow::kWait) {
    return;
  }
  for (std::size_t rank = 0; rank < kRanks; ++rank) {
    for (auto burst = waiting_[rank].begin(); burst != waiting_[rank].end();) {
      const auto next = std::next(burst);
      if (now - burst->second.last > options_.max_age) {
        drop({rank, burst});
      }
      burst = next;
    }
  }
  while (frames_ > options_.max_frames && size() > 1) {
    drop(last());
  }
}

// REQUIRES: not empty.
BurstQueue::Place BurstQueue::next() {
  bool is_left = false;  // by the rank before
  for (std::size_t rank = 0; rank < kRanks; ++rank) {
    Waiting& some = waiting_[rank];
    const bool others = std::any_of(waiting_.begin() + static_cast<std::ptrdiff_t>(rank) + 1,
                                    waiting_.end(),
                                    [](const Waiting& behind) { return !behind.empty(); });
    if (some.empty()) {
      continue;
    }
    if (others && ++before_others_[rank] % kOneOf == 0) {
      is_left = true;
      continue;
    }
    const bool in_turn = rank != kOther || is_left || ++before_others_[rank] % kOneOf == 0;
    return {rank, in_turn ? some.begin() : std::max_element(some.begin(), some.end(), is_older)};
  }
  RAYLOC_CHECK(false);
  return {};
}

// REQUIRES: not empty.
BurstQueue::Place BurstQueue::last() {
  for (std::size_t rank = kRanks; rank-- > 0;) {
    Waiting& some = waiting_[rank];
    if (!some.empty()) {
      return {rank,
              rank == kOther ? std::min_element(some.begin(), some.end(), is_older)
                             : std::prev(some.end())};
    }
  }
  RAYLOC_CHECK(false);
  return {};
}

Burst BurstQueue::pop() {
  RAYLOC_CHECK(!empty());
  return take(next());
}

Burst BurstQueue::take(const Place& place) {
  Burst burst = std::move(place.burst->second);
  place_.erase(burst.transmitter);
  waiting_[place.rank].erase(place.burst);
  frames_ -= frames_of(burst);
  return burst;
}

std::vector<Burst> BurstQueue::pop(std::size_t most) {
  std::vector<Burst> bursts;
  bool goes_on = true;
  while (goes_on && bursts.size() < most) {
    const Place place = next();
    bursts.push_back(take(place));
    goes_on = place.rank != kOther && size() > waiting_[kOther].size();
  }
  return bursts;
}

Timestamp BurstQueue::earliest(Timestamp time) const {
  for (const Waiting& some : waiting_) {
    for (const auto& [turn, burst] : some) {
      time = std::min(time, burst.first);
    }
  }
  return time;
}

}  // namespace rayloc
