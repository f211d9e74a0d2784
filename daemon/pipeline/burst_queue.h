// BurstQueue: bursts that have ended and wait to be processed.
//
// A fix takes milliseconds, and there may be many transmitters: waiting bursts must not grow old,
// and a crowd of unlisted transmitters must not delay the wanted ones. Live,
// - a transmitter has one place in the queue, and a burst that is still there when its next one
//   ends is replaced by that one;
// - bursts are processed by rank, and within a rank round-robin, so that the rates of its
//   transmitters fall alike;
// - each rank leaves every fourth place to those below it;
// - in the last rank, bursts that ended more than half a second ago come after the others: a
//   transmitter that continues has a newer one, and the others may have left. Every fourth place
//   goes to the newest burst of a transmitter that was not served within max_age: a transmitter
//   that sends less often loses its turn between two bursts;
// - a burst that has waited too long is dropped, and so is the last in order when too many wait:
//   of the ranks that leave less than a quarter of the frames to those below them, the lowest. Its
//   transmitter keeps its turn: the next burst counts as one that replaces the dropped one.
// The load then reduces the number of estimates and does not delay them. A replay waits instead:
// every burst keeps its own place, and the oldest is processed first.
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

// Priority of a transmitter's bursts when not all can be processed: listed transmitters before
// others, and of both those with a track before acquisitions, which take longer.
enum class Rank {
  kListed,             // a listed device with a track, or a fixed transmitter
  kListedAcquisition,  // a listed device without a track
  kTracked,            // an unlisted device with a track
  kOther
};
inline constexpr std::size_t kRanks = 4;  // number of values of Rank
using RankOf = std::function<Rank(const MacAddress& transmitter)>;
using IsWaiting = std::function<bool(const MacAddress& transmitter)>;

// Bursts of one rank since the start: ended = taken + merged + dropped + waiting.
struct RankCounts {
  std::uint64_t taken = 0;
  std::uint64_t merged = 0;   // replaced by a newer one of their transmitter
  std::uint64_t dropped = 0;  // too old, too many waited, or clear()
  std::uint64_t waiting = 0;

  std::uint64_t ended() const { return taken + merged + dropped + waiting; }
};

struct BurstQueueOptions {
  Overflow overflow = Overflow::kDropOldest;
  Duration max_age = std::chrono::seconds(3);  // since the last frame of a burst, live
  std::size_t max_frames = 8192;               // of the bursts that wait, live
  RankOf rank = [](const MacAddress&) { return Rank::kOther; };  // called when a burst ends
};

class BurstQueue {
 public:
  explicit BurstQueue(BurstQueueOptions options) : options_(std::move(options)) {}

  // Takes bursts that have ended, in the order of their ends. Live, bursts that are too old at
  // `now`, in event time, and those beyond the limit are dropped.
  void push(std::vector<Burst>& ended, Timestamp now);

  bool empty() const { return size() == 0; }
  std::size_t size() const;
  // REQUIRES: not empty.
  Burst pop();
  // The next bursts, at most `most`, to be processed together. A burst of rank kOther is the last
  // of them: it takes long, and no wanted transmitter should wait for it. REQUIRES: not empty.
  std::vector<Burst> pop(std::size_t most);

  // Drops every burst, and the turns of all transmitters: later bursts may be earlier in time.
  void clear();

  // Frames of the bursts that wait, surplus ones included.
  std::uint64_t frames() const;
  // Bursts that were replaced by a newer one since the start, and their frames, surplus ones
  // included.
  std::uint64_t merged_bursts() const { return sum_of(&RankCounts::merged); }
  std::uint64_t merged_frames() const { return merged_frames_; }
  // Bursts that were dropped, and their frames, surplus ones included.
  std::uint64_t dropped_bursts() const { return sum_of(&RankCounts::dropped); }
  std::uint64_t dropped_frames() const { return dropped_frames_; }
  // Live, by the rank of the transmitter when the burst ended. A replay counts all as kListed.
  const std::array<RankCounts, kRanks>& by_rank() const { return by_rank_; }
  // Live: true if a burst of the transmitter waits, or has been dropped because too many waited and
  // the next may follow: it is not silent.
  bool is_waiting(const MacAddress& transmitter) const;
  // The minimum of the first frames of the waiting bursts and of `time`.
  Timestamp earliest(Timestamp time) const;

 private:
  // Bursts of one rank, by the turn since which their transmitters wait.
  using Waiting = std::map<std::uint64_t, Burst>;
  // A transmitter whose burst was dropped because too many waited.
  struct GivenUp {
    std::uint64_t turn = 0;
    Timestamp received_since;
    Timestamp last;
  };
  struct Place {
    std::size_t rank = 0;
    Waiting::iterator burst;
  };

  std::uint64_t sum_of(std::uint64_t RankCounts::*count) const;
  void add(Burst&& burst, std::uint64_t turn);
  void add_anew(Burst&& burst);
  void replace(const Place& older, Burst&& burst);
  Burst remove(const Place& place);
  Burst take(const Place& place);
  void drop(const Place& place);
  void drop_old(Timestamp now);
  void drop_surplus();
  Place next();
  bool is_fresh(const Burst& burst) const;
  Waiting::iterator next_other();
  std::size_t widest_rank() const;
  Place last();

  const BurstQueueOptions options_;
  std::array<Waiting, kRanks> waiting_;
  std::array<RankCounts, kRanks> by_rank_{};
  std::array<std::uint64_t, kRanks> frames_of_rank_{};
  std::map<MacAddress, Place> place_;       // live: the place of each transmitter
  std::map<MacAddress, GivenUp> given_up_;  // their last frames are not older than max_age
  // Transmitters of rank kOther whose bursts were taken within max_age, and when.
  std::map<MacAddress, Timestamp> served_;
  Timestamp now_ = Timestamp::min();  // of the last push, live
  std::uint64_t turns_ = 0;
  // Bursts taken from a rank while lower ranks waited; all of the last rank.
  std::array<std::size_t, kRanks> before_others_{};
  std::uint64_t merged_frames_ = 0;
  std::uint64_t dropped_frames_ = 0;
};

}  // namespace rayloc
