#include "engine/trace/images/mirror_trie.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// A count, a power of two: the table doubles when half full.
constexpr std::size_t kFirstSlots = 1024;
constexpr std::uint32_t kNoParent = 0xffffffff;  // no index of a node

}  // namespace

MirrorTrie::MirrorTrie()
    : nodes_{{kNoParent, 0}},
      slots_(kFirstSlots, Slot{kEmpty, 0}),
      mask_(kFirstSlots - 1),
      shift_(64U - static_cast<unsigned>(std::countr_zero(kFirstSlots))) {}

std::uint32_t MirrorTrie::add(std::uint32_t node, std::uint32_t surface) {
  if (2 * nodes_.size() > slots_.size()) {
    const std::vector<Slot> old = std::exchange(slots_, {});
    slots_.assign(2 * old.size(), Slot{kEmpty, 0});
    mask_ = slots_.size() - 1;
    --shift_;
    for (const Slot& slot : old) {
      if (slot.key != kEmpty) {
        insert(slot.key, slot.node);
      }
    }
  }
  const auto added = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({node, surface});
  insert(key_of(node, surface), added);
  return added;
}

void MirrorTrie::insert(std::uint64_t key, std::uint32_t node) {
  std::size_t slot = hash(key) & mask_;
  while (slots_[slot].key != kEmpty) {
    slot = (slot + 1) & mask_;
  }
  slots_[slot] = {key, node};
}

void MirrorTrie::merge(const MirrorTrie& other) {
  std::vector<std::uint32_t> here(other.nodes_.size(), kRoot);
  for (std::size_t i = 1; i < other.nodes_.size(); ++i) {
    here[i] = extended(here[other.nodes_[i].parent], other.nodes_[i].surface);
  }
}

void MirrorTrie::put_in_order() {
  RAYLOC_CHECK(first_child_.empty());
  const std::size_t count = nodes_.size();
  // Level by level: children sorted by the new numbers of their parents, then by surface.
  std::vector<std::vector<std::uint32_t>> levels(1, {kRoot});
  std::vector<std::uint32_t> depth(count, 0);
  for (std::uint32_t i = 1; i < count; ++i) {
    depth[i] = depth[nodes_[i].parent] + 1;
    levels.resize(std::max<std::size_t>(levels.size(), depth[i] + 1));
    levels[depth[i]].push_back(i);
  }
  std::vector<std::uint32_t> number(count, 0);
  surfaces_.assign(1, 0);
  first_child_.assign(count + 1, static_cast<std::uint32_t>(count));
  for (std::size_t level = 1; level < levels.size(); ++level) {
    std::sort(levels[level].begin(), levels[level].end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(number[nodes_[a].parent], nodes_[a].surface) <
             std::tuple(number[nodes_[b].parent], nodes_[b].surface);
    });
    for (const std::uint32_t old : levels[level]) {
      number[old] = static_cast<std::uint32_t>(surfaces_.size());
      std::uint32_t& first = first_child_[number[nodes_[old].parent]];
      first = std::min(first, number[old]);
      surfaces_.push_back(nodes_[old].surface);
    }
  }
  // A node without children begins where the next one does.
  for (std::size_t i = count; i > 0; --i) {
    first_child_[i - 1] = std::min(first_child_[i - 1], first_child_[i]);
  }
  slots_ = {};
}

}  // namespace rayloc
