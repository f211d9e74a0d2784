// ImageTree: chains of up to `max_depth` reflections that start at a fixed point and could reach
// anywhere: the mirror images of that point, and where each mirror sends its waves.
//
// Exhaustive where that is possible: no chain is missed. A chain is left out only when geometry
// proves that no wave takes it: the mirror is seen from behind, lies behind the one before it,
// outside the beam that the one before it sends out (the beam is clipped polygon by polygon), or
// wholly behind another surface. What else stands in the way is tested per path. The size grows
// with the number of surfaces that see each other to the power of the depth. In large scenes and at
// great depths only sequences of mirrors that rays have met are followed (shooting.h says what may
// be missed); TraceOptions::candidates chooses, by an estimate of the work unless told.
//
// With transmission waves also reach the insides of objects, so both sides of every face reflect.
// With soft edges (TraceOptions::softness) mirrors are that much larger. In both cases what stands
// in the way does not end a path but changes it, so chains are then given whether clear or not,
// save those that surely cross too much.
//
// The tree depends on the scene and the point alone, so it is built once for each antenna of an
// access point and asked for any number of device positions. It remembers what it learned where it
// was asked (beam_index.h); the answers do not depend on that. The elements of an array, which
// light nearly the same, can have one tree together; each hears from it what it would from its own.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"
#include "engine/trace/images/beam_index.h"
#include "engine/trace/images/image_node.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct GrownTree;

// A chain that the geometry allows and, in a scene of opaque surfaces with hard edges, that nothing
// blocks.
struct SpecularChain {
  std::vector<std::uint32_t> surfaces;  // from the root on
  std::vector<Vec3d> points;            // of reflection, from the root on
};

class ImageTree {
 public:
  // REQUIRES: options.max_depth >= 0, options.rays > 0. The scene must outlive the tree.
  ImageTree(const Scene& scene, const Vec3d& root, const TraceOptions& options);

  // One tree for several points near each other, no more than kMaxRoots; nothing where rays are
  // shot, or nearly.
  static std::optional<ImageTree> shared(const Scene& scene,
                                         std::span<const Vec3d> roots,
                                         const TraceOptions& options);

  // All chains from the (first) root to `target`, line of sight included (an empty chain). Fills
  // `chains`, whose memory is used again, and returns how many there are.
  std::size_t chains_to(const Vec3d& target, std::vector<SpecularChain>& chains) const;

  // The same from root number `root`, one by one and without a copy: calls
  // visit(const SpecularChain&), whose argument lives until it returns.
  template <typename Visit>
  void visit_chains(std::size_t root, const Vec3d& target, const Visit& visit) const {
    SpecularChain chain;
    if (is_direct(root, target)) {
      visit(std::as_const(chain));
    }
    for (const std::uint32_t node : candidates(target)) {
      if (is_chain(root, node, target, chain)) {
        visit(std::as_const(chain));
      }
    }
  }

  // For whoever asks for more than points: sequences of mirrors by number, shorter ones first.
  const ImageNode& node(std::uint32_t number) const { return nodes_[number]; }
  const Vec3d& image(std::size_t root, std::uint32_t node) const {
    return images_[node * roots_.size() + root].point;
  }
  // Where the waves of each node go.
  const BeamIndex& beams() const { return *index_; }
  // Finds the points of reflection of node `leaf`; false when one is not on its surface.
  bool back_trace(std::size_t root,
                  std::uint32_t leaf,
                  const Vec3d& target,
                  SpecularChain& chain) const;
  // Whether nothing is in the way of the chain, or that matters to nobody.
  bool is_open(std::size_t root, const SpecularChain& chain, const Vec3d& target) const {
    return !clear_only_ || is_clear(root, chain, target);
  }

  const std::vector<Vec3d>& roots() const { return roots_; }
  std::size_t size() const { return nodes_.size(); }           // sequences of mirrors
  std::size_t bytes() const;                                   // of memory so far
  CandidateGenerator generator() const { return generator_; }  // that was used, not kAutomatic

 private:
  ImageTree(const Scene& scene,
            std::span<const Vec3d> roots,
            const TraceOptions& options,
            GrownTree grown);

  bool is_direct(std::size_t root, const Vec3d& target) const;  // a chain without mirrors
  std::vector<std::uint32_t> candidates(const Vec3d& target) const;
  // Whether the mirrors of `node` make a chain; it is then in `chain`.
  bool is_chain(std::size_t root,
                std::uint32_t node,
                const Vec3d& target,
                SpecularChain& chain) const {
    return back_trace(root, node, target, chain) && is_open(root, chain, target);
  }
  bool is_clear(std::size_t root, const SpecularChain& chain, const Vec3d& target) const;

  const Scene* scene_;
  std::vector<Vec3d> roots_;
  double margin_;    // of the mirrors [m]
  bool clear_only_;  // chains that something blocks are left out
  CandidateGenerator generator_;
  std::vector<ImageNode> nodes_;  // by depth; parents before children
  std::vector<Image> images_;     // of every root, node by node
  std::shared_ptr<const BeamIndex> index_;
};

}  // namespace rayloc
