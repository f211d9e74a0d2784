// BurstQueue: bursts that have ended and wait to be explained, the one that waits longest first.
//
// A fix takes milliseconds, and many transmitters may be heard: what waits must not grow old. Live,
// a transmitter has one place in the queue, and a burst that is still there when its next one ends
// gives the place to it: estimates are then fewer, never late. A replay waits instead: every burst
// keeps a place of its own.
//
// Thread safety: for one thread.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/frame_mailbox.h"

namespace rayloc {

class BurstQueue {
 public:
  explicit BurstQueue(Overflow overflow) : overflow_(overflow) {}

  // Takes bursts that have ended, in the order of their ends.
  void push(std::vector<Burst>& ended);

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
  // The least first frame of what waits, or `time` if that is earlier.
  Timestamp earliest(Timestamp time) const;

 private:
  const Overflow overflow_;
  std::list<Burst> waiting_;
  std::map<MacAddress, std::list<Burst>::iterator> place_;  // live: of each transmitter
  std::uint64_t frames_ = 0;
  std::uint64_t merged_bursts_ = 0;
  std::uint64_t merged_frames_ = 0;
};

}  // namespace rayloc
