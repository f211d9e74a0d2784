// MirrorTrie: a set of sequences of mirrors, as a tree: each node appends one mirror to its parent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rayloc {

class MirrorTrie {
 public:
  // The index of the empty sequence, which always exists.
  static constexpr std::uint32_t kRoot = 0;

  MirrorTrie();

  // Number of nodes, including the root.
  std::size_t size() const { return nodes_.size(); }

  // The node of the sequence of `node` with `surface` appended; a new one when there is none.
  std::uint32_t extended(std::uint32_t node, std::uint32_t surface) {
    const std::uint64_t key = key_of(node, surface);
    for (std::size_t slot = hash(key);; ++slot) {
      const Slot& found = slots_[slot & mask_];
      if (found.key == key) {
        return found.node;
      }
      if (found.key == kEmpty) {
        return add(node, surface);
      }
    }
  }

  // Adds all sequences of the other trie.
  void merge(const MirrorTrie& other);

  // Numbers the nodes by length, then by surfaces, so that the children of each are adjacent and
  // the trie of a set of sequences is unique. Nodes cannot be added afterwards.
  void put_in_order();

  // After put_in_order(): every surface of every sequence, with repetitions.
  std::span<const std::uint32_t> surfaces() const { return std::span(surfaces_).subspan(1); }

  // After put_in_order(): the number of the first child, and the surfaces of all
  // children, ascending.
  struct Children {
    std::uint32_t first;
    std::span<const std::uint32_t> surfaces;
  };
  Children children(std::uint32_t node) const {
    const std::uint32_t first = first_child_[node];
    return {first, std::span(surfaces_).subspan(first, first_child_[node + 1] - first)};
  }

 private:
  struct Node {
    std::uint32_t parent;
    std::uint32_t surface;
  };
  struct Slot {
    std::uint64_t key;
    std::uint32_t node;
  };
  // No valid key: its node would have the number 2^32 - 1.
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  static std::uint64_t key_of(std::uint32_t node, std::uint32_t surface) {
    return (std::uint64_t{node} << 32U) | surface;
  }
  // Fibonacci hashing, Knuth vol. 3, 6.4.
  std::size_t hash(std::uint64_t key) const { return (key * 0x9e3779b97f4a7c15U) >> shift_; }
  std::uint32_t add(std::uint32_t node, std::uint32_t surface);
  void insert(std::uint64_t key, std::uint32_t node);

  std::vector<Node> nodes_;  // parents before children
  std::vector<Slot> slots_;  // open addressing
  std::size_t mask_ = 0;
  unsigned shift_ = 0;
  // Valid after put_in_order().
  std::vector<std::uint32_t> first_child_;
  std::vector<std::uint32_t> surfaces_;
};

}  // namespace rayloc
