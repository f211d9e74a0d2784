// Sequencer: delivers the batches of all nodes of a site, each node's once and
// in the order of their numbers, whatever the broker did to them in transit.
//
// Its output is a function of the records of the stream alone: a batch is delivered after its
// predecessor; a hole is closed by the batch, by a gap mark, or by a new start of the node. All
// of these are records, so every reader of the stream delivers the same. It reads no clock.
//
// Thread safety: one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "daemon/live/cluster/batch.h"

namespace rayloc {

class Sequencer {
 public:
  struct Position {
    std::uint64_t epoch = 0;   // 0: no data of the node yet
    std::uint64_t number = 0;  // of the last batch that was taken or marked
    std::vector<std::uint64_t> past_epochs;
  };
  using Positions = std::map<std::string, Position>;  // by node

  // `from_the_beginning`: it receives every record of the stream, so that
  // a node's first batch is number 1. Otherwise a node without a position
  // may begin with any number: earlier batches do not count as missing.
  Sequencer(Positions positions, bool from_the_beginning);

  struct Taken {
    std::string node;
    Batch batch;
  };
  // Adds the next record of the stream. Appends the batches that are now in order to `out`.
  void push(const std::string& node, Batch batch, std::vector<Taken>& out);

  // A range of batches that is missing now, to be requested.
  struct Hole {
    std::string node;
    std::uint64_t epoch = 0;
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    friend auto operator<=>(const Hole&, const Hole&) = default;
  };
  std::vector<Hole> holes() const;
  bool has_holes() const { return held_ > 0; }

  Positions positions() const;

  // batches pushed = taken + repeats + late + held.
  struct Counters {
    std::uint64_t pushed = 0;
    std::uint64_t taken = 0;
    std::uint64_t repeats = 0;  // taken before, or held
    std::uint64_t late = 0;     // of an earlier start of the node
    std::uint64_t held = 0;     // until their predecessors arrive
    std::uint64_t marked = 0;   // numbers covered by marks
    std::uint64_t missing =
        0;  // numbers covered by nothing: the node was restarted, or too many were held
    std::map<std::string, std::uint64_t> marked_datagrams;  // by access point
  };
  Counters counters() const;

 private:
  struct Node {
    Position at;
    std::map<std::uint64_t, Batch> held;     // by number
    std::map<std::uint64_t, BatchGap> gaps;  // by their first number; not passed yet
  };

  void begin_epoch(const std::string& name,
                   Node& node,
                   const Batch& batch,
                   std::vector<Taken>& out);
  void take_in_order(const std::string& name, Node& node, std::vector<Taken>& out);
  bool pass_gap(Node& node);
  void pass_missing(const std::string& name, Node& node, std::vector<Taken>& out);

  const bool from_the_beginning_;
  std::map<std::string, Node> nodes_;
  std::size_t held_ = 0;
  Counters counters_;
};

}  // namespace rayloc
