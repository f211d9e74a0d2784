// BurstQueue: bursts that have ended and wait to be explained.
//
// A fix takes milliseconds, and many transmitters may be heard: what waits must not grow old, and a
// crowd of strangers must not keep anybody waiting who is wanted. Live,
// - a transmitter has one place in the queue, and a burst that is still there when its next one
//   ends gives the place to it;
// - transmitters that the site lists come first, then those with a track, each of both in turn, so
//   that the rates of all fall alike; of the others the newest comes first;
// - each rank leaves every fourth place to those behind it, and of the others it is theirs whose
//   turn it is, so that nobody waits for ever;
// - what has waited too long is dropped, and so is the last in that order when too much waits.
// Estimates are then fewer, never late. A replay waits instead: every burst keeps a place of its
// own, and the one that waits longest comes first.
//
// Thread safety: for one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/frame_mailbox.h"

namespace rayloc {

// Whose bursts are explained first, when not all can be.
enum class Rank { kListed, kTracked, kOther };
using RankOf = std::function<Rank(const MacAddress& transmitter)>;

struct BurstQueueOptions {
  Overflow overflow = Overflow::kDropOldest;
  Duration max_age = std::chrono::seconds(3);  // since the last frame of a burst, live
  std::size_t max_frames = 8192;               // of the bursts that wait, live
  RankOf rank = [](const MacAddress&) { return Rank::kOther; };  // asked when a burst ends
};

class BurstQueue {
 public:
  explicit BurstQueue(BurstQueueOptions options) : options_(std::move(options)) {}

  // Takes bursts that have ended, in the order of their ends. Live, what is too old at `now` is
  // dropped, in event time, and what is too much.
  void push(std::vector<Burst>& ended, Timestamp now);

  bool empty() const { return size() == 0; }
  std::size_t size() const;
  // REQUIRES: not empty.
  Burst pop();
  // The next ones, `most` at most, to be explained together. A stranger is the last of them: it
  // takes long, and who is wanted should not wait for it. REQUIRES: not empty.
  std::vector<Burst> pop(std::size_t most);

  // Frames of the bursts that wait, surplus ones included.
  std::uint64_t frames() const { return frames_; }
  // Bursts that gave their place to a newer one since the start, and their frames, surplus ones
  // included.
  std::uint64_t merged_bursts() const { return merged_bursts_; }
  std::uint64_t merged_frames() const { return merged_frames_; }
  // The same of bursts that were dropped.
  std::uint64_t dropped_bursts() const { return dropped_bursts_; }
  std::uint64_t dropped_frames() const { return dropped_frames_; }
  // The least first frame of what waits, or `time` if that is earlier.
  Timestamp earliest(Timestamp time) const;

 private:
  static constexpr std::size_t kRanks = 3;  // of Rank
  // Of one rank, by the turn since which their transmitters wait.
  using Waiting = std::map<std::uint64_t, Burst>;
  struct Place {
    std::size_t rank = 0;
    Waiting::iterator burst;
  };

  void add(Burst&& burst, std::uint64_t turn);
  void replace(const Place& older, Burst&& burst);
  void drop(const Place& place);
  Place next();
  Burst take(const Place& place);
  Place last();

  const BurstQueueOptions options_;
  std::array<Waiting, kRanks> waiting_;
  std::map<MacAddress, Place> place_;  // live: of each transmitter
  std::uint64_t turns_ = 0;
  // Bursts that a rank has taken while others waited behind it; the last rank, by being newer.
  std::array<std::size_t, kRanks> before_others_{};
  std::uint64_t frames_ = 0;
  std::uint64_t merged_bursts_ = 0;
  std::uint64_t merged_frames_ = 0;
  std::uint64_t dropped_bursts_ = 0;
  std::uint64_t dropped_frames_ = 0;
};

}  // namespace rayloc
