// HeightBoxes: what is expected of a device in one cell and one layer of heights, made when
// somebody looks there and kept while there is room.
//
// Few cells of a room are looked at so closely, and mostly the same again: those along a walk. What
// is kept changes the time of a fix and nothing else.
//
// Thread safety: may be used from many threads.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "engine/likelihood/likelihood.h"

namespace rayloc {

class HeightBoxes {
 public:
  using Box = std::shared_ptr<const PlaceLikelihood>;

  // The box of this number; make(): a PlaceLikelihood. REQUIRES: it always makes the same.
  template <typename Make>
  Box get(std::size_t number, const Make& make) const {
    Shard& shard = shards_[number % shards_.size()];
    {
      const std::lock_guard lock(shard.mutex);
      if (const auto found = shard.boxes.find(number); found != shard.boxes.end()) {
        return found->second;
      }
    }
    auto made = std::make_shared<const PlaceLikelihood>(make());
    const std::lock_guard lock(shard.mutex);
    const auto [place, is_new] = shard.boxes.emplace(number, made);
    if (is_new) {
      shard.order.push_back(number);
      if (shard.order.size() > kMost) {
        shard.boxes.erase(shard.order.front());
        shard.order.pop_front();
      }
    }
    return made;
  }

 private:
  // A count of boxes of a shard, chosen: 16384 in all, of 3 kB each at 40 MHz.
  static constexpr std::size_t kMost = 1024;
  struct Shard {
    std::mutex mutex;
    std::unordered_map<std::size_t, Box> boxes;
    std::deque<std::size_t> order;  // in which they were made
  };
  mutable std::array<Shard, 16> shards_;
};

}  // namespace rayloc
