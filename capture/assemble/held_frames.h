// HeldFrames: holds frames back until a second access point would have been detected.
//
// The release depends on the times of datagrams alone. Thread safety: one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc {

class HeldFrames {
 public:
  // Beyond it the oldest is released.
  static constexpr std::size_t kCapacity = 256;

  struct Held {
    CsiFrame frame;
    std::uint64_t datagrams = 0;
  };

  explicit HeldFrames(Duration settle) : settle_(settle) {}

  // Frames are held from `time` on, for the settling time.
  void hold_from(Timestamp time) { from_ = time; }
  bool holds(Timestamp now) const;

  void add(Held held) { frames_.push_back(std::move(held)); }
  bool is_full() const { return frames_.size() >= kCapacity; }
  // Moves out the frames whose wait is over; all of them at the end of the input.
  std::vector<Held> release(Timestamp now);
  std::vector<Held> release_all();
  Held release_oldest();  // REQUIRES: the queue is not empty

  std::uint64_t datagrams() const;
  Timestamp earliest(Timestamp otherwise) const;

 private:
  Duration settle_;
  Timestamp from_ = Timestamp::min();
  std::deque<Held> frames_;
};

}  // namespace rayloc
