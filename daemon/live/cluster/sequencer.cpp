#include "daemon/live/cluster/sequencer.h"

#include <algorithm>
#include <utility>

namespace rayloc {
namespace {

constexpr std::size_t kMaxHeld = 4096;  // batches of a node after a hole; then it is given up
// Starts of a node whose batches are still recognised: one a second for the retention of streams.
constexpr std::size_t kEpochsKnown = 60;

}  // namespace

Sequencer::Sequencer(Positions positions, bool from_the_beginning)
    : from_the_beginning_(from_the_beginning) {
  for (auto& [name, position] : positions) {
    nodes_[name].at = std::move(position);
  }
}

void Sequencer::push(const std::string& name, Batch batch, std::vector<Taken>& out) {
  ++counters_.pushed;
  Node& node = nodes_[name];
  if (batch.epoch != node.at.epoch) {
    const auto& past = node.at.past_epochs;
    if (std::find(past.begin(), past.end(), batch.epoch) != past.end()) {
      ++counters_.late;
      return;
    }
    begin_epoch(name, node, batch, out);
  }
  if (batch.number <= node.at.number || node.held.count(batch.number) != 0) {
    ++counters_.repeats;
    return;
  }
  for (BatchGap& gap : batch.gaps) {
    if (gap.to > node.at.number) {
      node.gaps.emplace(gap.from, gap);
    }
  }
  node.held.emplace(batch.number, std::move(batch));
  ++held_;
  take_in_order(name, node, out);
  while (node.held.size() > kMaxHeld) {
    pass_missing(name, node, out);
  }
}

// Delivers the held batches of the previous start, whose holes are not filled any more.
void Sequencer::begin_epoch(const std::string& name,
                            Node& node,
                            const Batch& batch,
                            std::vector<Taken>& out) {
  const bool is_known = node.at.epoch != 0;
  while (!node.held.empty()) {
    pass_missing(name, node, out);
  }
  node.gaps.clear();
  if (is_known) {
    auto& past = node.at.past_epochs;
    past.push_back(node.at.epoch);
    if (past.size() > kEpochsKnown) {
      past.erase(past.begin());
    }
  }
  const bool misses_nothing = is_known || from_the_beginning_ || batch.oldest_kept == 1;
  node.at.epoch = batch.epoch;
  node.at.number = misses_nothing ? 0 : batch.number - 1;
}

void Sequencer::take_in_order(const std::string& name, Node& node, std::vector<Taken>& out) {
  for (;;) {
    const auto first = node.held.begin();
    if (first != node.held.end() && first->first == node.at.number + 1) {
      ++node.at.number;
      ++counters_.taken;
      --held_;
      out.push_back({name, std::move(first->second)});
      node.held.erase(first);
    } else if (!pass_gap(node)) {
      return;
    }
  }
}

// Returns true if a mark covers the next number.
bool Sequencer::pass_gap(Node& node) {
  while (!node.gaps.empty()) {
    const auto first = node.gaps.begin();
    const BatchGap& gap = first->second;
    if (gap.from > node.at.number + 1) {
      return false;
    }
    const bool passes = gap.to > node.at.number;
    if (passes) {
      counters_.marked += gap.to - node.at.number;
      for (const auto& [access_point, count] : gap.datagrams) {
        counters_.marked_datagrams[access_point] += count;
      }
      node.at.number = gap.to;
      // Held under a marked number: it arrived after all, and too late.
      while (!node.held.empty() && node.held.begin()->first <= gap.to) {
        node.held.erase(node.held.begin());
        --held_;
        ++counters_.repeats;
      }
    }
    node.gaps.erase(first);
    if (passes) {
      return true;
    }
  }
  return false;
}

// REQUIRES: a batch is held.
void Sequencer::pass_missing(const std::string& name, Node& node, std::vector<Taken>& out) {
  const std::uint64_t held = node.held.begin()->first;
  const std::uint64_t marked = node.gaps.empty() ? held : node.gaps.begin()->first;
  const std::uint64_t next = std::min(held, marked);
  counters_.missing += next - 1 - node.at.number;
  node.at.number = next - 1;
  take_in_order(name, node, out);
}

std::vector<Sequencer::Hole> Sequencer::holes() const {
  std::vector<Hole> holes;
  for (const auto& [name, node] : nodes_) {
    std::uint64_t next = node.at.number + 1;
    const auto up_to = [&, epoch = node.at.epoch, &node_name = name](std::uint64_t known,
                                                                     std::uint64_t known_to) {
      if (known > next) {
        holes.push_back({node_name, epoch, next, known - 1});
      }
      next = std::max(next, known_to + 1);
    };
    auto gap = node.gaps.begin();
    for (const auto& [number, batch] : node.held) {
      for (; gap != node.gaps.end() && gap->first < number; ++gap) {
        up_to(gap->first, gap->second.to);
      }
      up_to(number, number);
    }
  }
  return holes;
}

Sequencer::Positions Sequencer::positions() const {
  Positions positions;
  for (const auto& [name, node] : nodes_) {
    positions[name] = node.at;
  }
  return positions;
}

Sequencer::Counters Sequencer::counters() const {
  Counters counters = counters_;
  counters.held = held_;
  return counters;
}

}  // namespace rayloc
