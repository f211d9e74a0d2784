// MirrorGrower: finds the mirrors that the beam of one mirror lights, and adds them to a tree of
// images (image_tree.h). One per thread: it holds scratch memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/images/beam.h"
#include "engine/trace/images/beam_index.h"
#include "engine/trace/images/image_node.h"
#include "engine/trace/images/mirror_table.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

class MirrorTrie;

// Data of the nodes of one level that the next level needs.
struct LitWindows {
  std::vector<std::uint8_t> crossings;  // certain crossings on the path to each node
  std::vector<std::size_t> ends;        // end index in corners, of each node's window
  std::vector<Vec3d> corners;
  std::vector<std::uint32_t> trie_nodes;  // of each node; empty without a trie

  std::span<const Vec3d> window(std::size_t i) const {
    const std::size_t first = i == 0 ? 0 : ends[i - 1];
    return std::span(corners).subspan(first, ends[i] - first);
  }
  void append(const LitWindows& other);
};

// Some nodes of one level.
struct GrownNodes {
  std::vector<ImageNode> nodes;
  std::vector<Image> images;      // of every root, node by node
  std::vector<BeamBounds> beams;  // beam of each node
  LitWindows windows;             // empty at the last level
};

class MirrorGrower {
 public:
  // The node whose children are grown.
  struct Parent {
    std::uint32_t node = kRootNode;  // number in the tree
    std::span<const Image> images;   // of every root; for the roots themselves, the roots
    RootSet roots = 0;
    std::uint32_t surface = kNoSurface;
    std::span<const Vec3d> window = {};  // the part of the surface that the chain so far lights
    int crossings = 0;
    int depth = 0;                // mirrors so far
    std::uint32_t trie_node = 0;  // kNoTrieNode: no ray has met this sequence
  };
  static constexpr std::uint32_t kNoTrieNode = 0xffffffff;  // no index of a node

  // All arguments must outlive the grower. With a trie (in order) mirrors follow each other as in
  // the trie, and other surfaces of the same objects are added, which rays may have missed.
  MirrorGrower(const Scene& scene,
               const MirrorTable& table,
               const TraceOptions& options,
               const MirrorTrie* trie)
      : scene_(scene), table_(table), options_(options), trie_(trie) {}

  // Appends the children of a parent to `grown`, by number of their surfaces.
  void grow(const Parent& parent, GrownNodes& grown);

 private:
  // A mirror that the beam lights, from one of its sides.
  struct Lit {
    std::uint32_t surface;
    RootSet roots;
    double side;               // its sign is the side of the plane on which their images are
    std::size_t first, count;  // corners of the window, in corners_
    double size;               // about the solid angle of the window
  };
  // A surface that may block others.
  struct Occluder {
    std::uint32_t surface;
    const Surface* shape;
    double size;
  };

  void find_lit(const Parent& parent);
  void find_proposed(std::uint32_t trie_node);
  std::uint32_t trie_child(std::uint32_t trie_node, std::uint32_t surface) const;
  bool light(std::uint32_t surface, double side, std::span<const Vec3d> window);
  void choose_occluders();
  // Number of surfaces that hide the window from all roots that light it; no more than `limit` + 1.
  int crossings(const Parent& parent, const Plane<double>* start, const Lit& lit, int limit) const;
  void add(const Parent& parent, const Lit& lit, int crossings, GrownNodes& grown);

  const Scene& scene_;
  const MirrorTable& table_;
  const TraceOptions& options_;
  const MirrorTrie* trie_;

  std::vector<Vec3d> apexes_;          // images of the parent's roots
  std::vector<Plane<double>> bounds_;  // of its beam
  std::vector<std::uint32_t> found_;
  std::vector<Lit> lit_;
  std::vector<Vec3d> corners_;
  std::vector<std::size_t> order_;  // of lit_
  std::vector<Occluder> occluders_;
  Polygon polygon_;
  Polygon scratch_;
  std::vector<Plane<double>> planes_;
};

}  // namespace rayloc
