// LitEdges: the edges that one end of a link may light, directly and over mirrors.
//
// Exhaustive like the image tree: an edge is left out only when geometry proves that no wave
// reaches it (outside of the beam of the last mirror; from within the wedge). Obstructions are
// tested for each path (edge_finder.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/trace/diffraction/edge_path.h"
#include "engine/trace/images/image_tree.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// A path to some part of an edge.
struct LitEdge {
  std::uint32_t node = kRootNode;  // of the tree: the mirrors on the path, from the end on
  std::uint32_t mirrors = 0;       // their number
  OffEdge<double> image;           // the end, seen through them
  double lower = 0.0;              // [m], the part lies between these heights
  double upper = 0.0;
};

class LitEdges {
 public:
  // For root number `root` of the tree, over as many mirrors as options allow before an edge.
  LitEdges(const TraceContext& context, std::shared_ptr<const ImageTree> tree, std::size_t root);

  std::span<const LitEdge> of(std::uint32_t edge) const {
    return std::span(lit_).subspan(first_[edge], first_[edge + 1] - first_[edge]);
  }
  const ImageTree& tree() const { return *tree_; }
  std::size_t root() const { return root_; }
  const Vec3d& end() const { return tree_->roots()[root_]; }  // [m], position of the end
  std::size_t size() const { return lit_.size(); }

 private:
  class Search;

  std::shared_ptr<const ImageTree> tree_;
  std::size_t root_;
  std::vector<LitEdge> lit_;        // edge by edge
  std::vector<std::size_t> first_;  // start index of each edge, and the end
};

// A tree for one end that no other code uses.
std::shared_ptr<const ImageTree> edge_tree(const TraceContext& context, const Vec3d& end);

}  // namespace rayloc
