#include "daemon/pipeline/burst_queue.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// A rank leaves one in this many bursts, and one in this many frames that wait, to the ranks below
// it.
constexpr std::size_t kOneOf = 4;
constexpr auto kOther = static_cast<std::size_t>(Rank::kOther);
// Age of the last frame from which on a burst of the last rank comes after the others. Chosen: two
// bursts of a transmitter that continues. With one second, such a transmitter was served half as
// often in a flood of random addresses.
constexpr Duration kFresh = std::chrono::milliseconds(500);

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

std::uint64_t BurstQueue::sum_of(std::uint64_t RankCounts::*count) const {
  std::uint64_t sum = 0;
  for (const RankCounts& counts : by_rank_) {
    sum += counts.*count;
  }
  return sum;
}

std::uint64_t BurstQueue::frames() const {
  return std::accumulate(frames_of_rank_.begin(), frames_of_rank_.end(), std::uint64_t{0});
}

void BurstQueue::add(Burst&& burst, std::uint64_t turn) {
  const MacAddress transmitter = burst.transmitter;
  const bool live = options_.overflow == Overflow::kDropOldest;
  const auto rank = live ? static_cast<std::size_t>(options_.rank(transmitter)) : 0;
  frames_of_rank_[rank] += frames_of(burst);
  ++by_rank_[rank].waiting;
  const auto added = waiting_[rank].emplace(turn, std::move(burst)).first;
  if (live) {
    place_.insert_or_assign(transmitter, Place{rank, added});
  }
}

// REQUIRES: the transmitter has no place.
void BurstQueue::add_anew(Burst&& burst) {
  std::uint64_t turn = ++turns_;
  if (const auto before = given_up_.find(burst.transmitter); before != given_up_.end()) {
    turn = before->second.turn;
    burst.received_since = before->second.received_since;
    given_up_.erase(before);
  }
  add(std::move(burst), turn);
}

Burst BurstQueue::remove(const Place& place) {
  Burst burst = std::move(place.burst->second);
  place_.erase(burst.transmitter);
  waiting_[place.rank].erase(place.burst);
  frames_of_rank_[place.rank] -= frames_of(burst);
  --by_rank_[place.rank].waiting;
  return burst;
}

// The newer burst keeps the turn of the older.
void BurstQueue::replace(const Place& older, Burst&& burst) {
  const std::uint64_t turn = older.burst->first;
  const Burst before = remove(older);
  merged_frames_ += frames_of(before);
  ++by_rank_[older.rank].merged;
  burst.received_since = before.received_since;
  add(std::move(burst), turn);
}

void BurstQueue::drop(const Place& place) {
  dropped_frames_ += frames_of(remove(place));
  ++by_rank_[place.rank].dropped;
}

void BurstQueue::push(std::vector<Burst>& ended, Timestamp now) {
  for (Burst& burst : ended) {
    const auto place = place_.find(burst.transmitter);
    if (place == place_.end()) {
      add_anew(std::move(burst));
    } else {
      replace(Place(place->second), std::move(burst));
    }
  }
  ended.clear();
  if (options_.overflow == Overflow::kDropOldest) {
    now_ = now;
    drop_old(now);
    drop_surplus();
  }
}

void BurstQueue::drop_old(Timestamp now) {
  for (std::size_t rank = 0; rank < kRanks; ++rank) {
    for (auto burst = waiting_[rank].begin(); burst != waiting_[rank].end();) {
      const auto next = std::next(burst);
      if (now - burst->second.last > options_.max_age) {
        drop({rank, burst});
      }
      burst = next;
    }
  }
  std::erase_if(given_up_,
                [&](const auto& one) { return now - one.second.last > options_.max_age; });
  std::erase_if(served_, [&](const auto& one) { return now - one.second > options_.max_age; });
}

// The transmitters keep their turns: otherwise those whose bursts end just after a place has become
// free would take it every time, and others would never be served.
void BurstQueue::drop_surplus() {
  while (frames() > options_.max_frames && size() > 1) {
    const Place place = last();
    const auto& [turn, burst] = *place.burst;
    given_up_.insert_or_assign(burst.transmitter, GivenUp{turn, burst.received_since, burst.last});
    drop(place);
  }
}

void BurstQueue::clear() {
  for (std::size_t rank = 0; rank < kRanks; ++rank) {
    while (!waiting_[rank].empty()) {
      drop({rank, waiting_[rank].begin()});
    }
  }
  given_up_.clear();
  served_.clear();
}

bool BurstQueue::is_fresh(const Burst& burst) const { return now_ - burst.last <= kFresh; }

// REQUIRES: a burst of rank kOther waits.
BurstQueue::Waiting::iterator BurstQueue::next_other() {
  Waiting& some = waiting_[kOther];
  if (++before_others_[kOther] % kOneOf == 0) {
    auto newest = some.end();
    for (auto one = some.begin(); one != some.end(); ++one) {
      if (served_.count(one->second.transmitter) == 0 &&
          (newest == some.end() || is_older(*newest, *one))) {
        newest = one;
      }
    }
    if (newest != some.end()) {
      return newest;
    }
  }
  const auto fresh =
      std::find_if(some.begin(), some.end(), [&](const auto& one) { return is_fresh(one.second); });
  return fresh != some.end() ? fresh : some.begin();
}

// REQUIRES: not empty.
BurstQueue::Place BurstQueue::next() {
  for (std::size_t rank = 0; rank < kRanks; ++rank) {
    Waiting& some = waiting_[rank];
    const bool others = std::any_of(waiting_.begin() + static_cast<std::ptrdiff_t>(rank) + 1,
                                    waiting_.end(),
                                    [](const Waiting& behind) { return !behind.empty(); });
    if (some.empty()) {
      continue;
    }
    if (others && ++before_others_[rank] % kOneOf == 0) {
      continue;
    }
    return {rank, rank == kOther ? next_other() : some.begin()};
  }
  RAYLOC_CHECK(false);
  return {};
}

// The lowest of the ranks that have several bursts and more frames than they may; if there is none,
// the lowest with a burst. REQUIRES: not empty.
std::size_t BurstQueue::widest_rank() const {
  std::uint64_t free = options_.max_frames;
  std::uint64_t below = frames();
  std::size_t lowest = 0;
  std::optional<std::size_t> widest;
  for (std::size_t rank = 0; rank < kRanks; ++rank) {
    below -= frames_of_rank_[rank];
    const std::uint64_t allowed = free - std::min(below, free / kOneOf);
    if (frames_of_rank_[rank] > allowed && waiting_[rank].size() > 1) {
      widest = rank;
    }
    lowest = waiting_[rank].empty() ? lowest : rank;
    free -= std::min(frames_of_rank_[rank], allowed);
  }
  return widest.value_or(lowest);
}

// REQUIRES: not empty.
BurstQueue::Place BurstQueue::last() {
  const std::size_t rank = widest_rank();
  Waiting& some = waiting_[rank];
  if (rank == kOther) {
    const auto oldest = std::min_element(some.begin(), some.end(), is_older);
    if (!is_fresh(oldest->second)) {
      return {rank, oldest};
    }
  }
  return {rank, std::prev(some.end())};
}

Burst BurstQueue::take(const Place& place) {
  ++by_rank_[place.rank].taken;
  if (place.rank == kOther) {
    served_.insert_or_assign(place.burst->second.transmitter, now_);
  }
  return remove(place);
}

Burst BurstQueue::pop() {
  RAYLOC_CHECK(!empty());
  return take(next());
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

bool BurstQueue::is_waiting(const MacAddress& transmitter) const {
  return place_.count(transmitter) > 0 || given_up_.count(transmitter) > 0;
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
