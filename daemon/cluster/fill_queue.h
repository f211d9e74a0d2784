// FillQueue: batches that marks of gaps have taken the place of, on their way to the stream of
// history: one after the other, so that they never stand in the way of what is heard now. What is
// more than it keeps is in the recordings of the node alone.
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

#include "daemon/cluster/numbered_ring.h"

namespace rayloc {

class FillQueue {
 public:
  using Time = NumberedRing::Time;
  using Counts = NumberedRing::Counts;

  struct Limits {
    std::size_t bytes = std::size_t{64} << 20U;  // the oldest gives way
    // What has not been acknowledged by then is sent again.
    Duration patience = std::chrono::seconds(1);
  };

  explicit FillQueue(const Limits& limits) : limits_(limits) {}

  // Of a number that a mark stands for; ascending.
  void add(const Batch& batch);

  struct Ready {
    std::uint64_t number = 0;
    std::shared_ptr<const std::string> bytes;
  };
  // What is to be sent now: one at a time.
  std::optional<Ready> next(Time now);
  void acknowledged(std::uint64_t number);

  // Datagrams by access point. Those of marks that are in neither are not filled in.
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
