// FillQueue: batches replaced by gap marks, in transit to the history
// stream: sent one after the other, so that they never delay live data.
// Batches beyond its limit are in the recordings of the node alone.
//
// It reads no clock. Thread safety: one thread at a time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "daemon/live/cluster/numbered_ring.h"

namespace rayloc {

class FillQueue {
 public:
  using Time = NumberedRing::Time;
  using Counts = NumberedRing::Counts;

  struct Limits {
    std::size_t bytes = std::size_t{64} << 20U;  // beyond it, the oldest is dropped
    // A batch that has not been acknowledged by then is sent again.
    Duration patience = std::chrono::seconds(1);
  };

  explicit FillQueue(const Limits& limits) : limits_(limits) {}

  // Adds a batch that a mark replaces; in ascending order of numbers.
  void add(const Batch& batch);

  struct Ready {
    std::uint64_t number = 0;
    std::shared_ptr<const std::string> bytes;
  };
  // Next batch to send now: one at a time.
  std::optional<Ready> next(Time now);
  void acknowledged(std::uint64_t number);

  // Datagrams by access point. Marked datagrams that are in neither are not filled in.
  const Counts& filled() const { return filled_; }
  const Counts& waiting() const { return waiting_; }

 private:
  struct Waiting {
    std::uint64_t number = 0;
    std::shared_ptr<const std::string> bytes;
    Counts counts;
  };
  void take_out_first(Counts* to);

  const Limits limits_;
  std::deque<Waiting> batches_;
  std::size_t bytes_ = 0;
  std::optional<Time> sent_;  // the first of them
  Counts filled_;
  Counts waiting_;
};

}  // namespace rayloc
