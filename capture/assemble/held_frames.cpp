#include "capture/assemble/held_frames.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace rayloc {

bool HeldFrames::holds(Timestamp now) const {
  if (settle_ <= Duration::zero() || from_ == Timestamp::min()) {
    return false;
  }
  // When the clock is set back, `from_` is in the future.
  const Duration passed = now < from_ ? from_ - now : now - from_;
  return passed < settle_;
}

std::vector<HeldFrames::Held> HeldFrames::release(Timestamp now) {
  return holds(now) ? std::vector<Held>() : release_all();
}

std::vector<HeldFrames::Held> HeldFrames::release_all() {
  std::vector<Held> all(std::make_move_iterator(frames_.begin()),
                        std::make_move_iterator(frames_.end()));
  frames_.clear();
  return all;
}

HeldFrames::Held HeldFrames::release_oldest() {
  Held oldest = std::move(frames_.front());
  frames_.pop_front();
  return oldest;
}

std::uint64_t HeldFrames::datagrams() const {
  std::uint64_t sum = 0;
  for (const Held& held : frames_) {
    sum += held.datagrams;
  }
  return sum;
}

Timestamp HeldFrames::earliest(Timestamp otherwise) const {
  for (const Held& held : frames_) {
    otherwise = std::min(otherwise, held.frame.time);
  }
  return otherwise;
}

}  // namespace rayloc
