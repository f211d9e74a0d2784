// BurstQueue: bursts that have ended and wait to be explained.
//
// A fix takes milliseconds, and many transmitters may be heard: what waits must not grow old, and a
// crowd of strangers must not keep anybody waiting who is wanted. Live,
// - a transmitter has one place in the queue, and a burst that is still there when its next one
//   ends gives the place to it;
// - transmitters that the site lists come first, then those with a track, each of both in turn; of
//   the others the newest comes first;
// - what has waited too long is dropped, and so is the last in that order when too much waits.
// Estimates are then fewer, never late. A replay waits instead: every burst keeps a place of its
// own, and the one that waits longest comes first.
//
// Thread safety: for one thread.
#pragma once

#include <compare>
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

  bool empty() const { return waiting_.empty(); }
  std::size_t size() const { return waiting_.size(); }
  // REQUIRES: not empty.
  Burst pop();

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
  // In the order in which they are explained.
  struct Place {
    Rank rank = Rank::kOther;
    Duration newest{};       // since then its last frame is older; of strangers alone
    std::uint64_t turn = 0;  // since then it waits

    auto operator<=>(const Place&) const = default;
  };
  using Waiting = std::map<Place, Burst>;

  Place place_of(const Burst& burst, std::uint64_t turn) const;
  void add(Burst&& burst, std::uint64_t turn);
  void replace(Waiting::iterator older, Burst&& burst);
  Waiting::iterator drop(Waiting::iterator burst);

  const BurstQueueOptions options_;
  Waiting waiting_;
  std::map<MacAddress, Waiting::iterator> place_;  // live: of each transmitter
  std::uint64_t turns_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t merged_bursts_ = 0;
  std::uint64_t merged_frames_ = 0;
  std::uint64_t dropped_bursts_ = 0;
  std::uint64_t dropped_frames_ = 0;
};

}  // namespace rayloc
