// ImageTree: chains of up to `max_depth` reflections that start at a fixed point and end at any
// position: the mirror images of that point, and the beam of each mirror.
//
// Exhaustive where that is possible: no chain is missed. A chain is left out only when geometry
// proves that no wave takes it: the mirror is seen from behind, lies behind the previous one,
// outside the beam of the previous one (the beam is clipped polygon by polygon), or wholly behind
// another surface. Other obstructions are tested per path. The size grows with the number of
// surfaces that see each other to the power of the depth. In large scenes and at great depths only
// sequences of mirrors that rays have met are followed (shooting.h lists what may be missed);
// TraceOptions::candidates chooses; by default an estimate of the work decides.
//
// With transmission waves also reach the insides of objects, so both sides of every face reflect.
// With soft edges (TraceOptions::softness) mirrors are larger by that length. In both cases an
// obstruction does not end a path but changes it, so chains are then returned whether clear or not,
// except those that certainly cross too many faces.
//
// The tree depends on the scene and the point alone, so it is built once for each antenna of an
// access point and queried for any number of device positions. It caches results by region
// (beam_index.h); the answers do not depend on that. The elements of an array, which light nearly
// the same surfaces, can share one tree; the result for each is that of a separate tree.
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

// A chain that the geometry allows and, in a scene of opaque surfaces with hard edges,
// that is not blocked.
struct SpecularChain {
  std::vector<std::uint32_t> surfaces;  // from the root on
  std::vector<Vec3d> points;            // of reflection, from the root on
};

class ImageTree {
 public:
  // REQUIRES: options.max_depth >= 0, options.rays > 0. The scene must outlive the tree.
  ImageTree(const Scene& scene, const Vec3d& root, const TraceOptions& options);

  // One tree for several points near each other, no more than kMaxRoots; nothing where rays are
  // shot, or the work is near that limit.
  static std::optional<ImageTree> shared(const Scene& scene,
                                         std::span<const Vec3d> roots,
                                         const TraceOptions& options);

  // All chains from the (first) root to `target`, line of sight included (an empty chain). Fills
  // `chains`, whose memory is reused, and returns how many there are.
  std::size_t chains_to(const Vec3d& target, std::vector<SpecularChain>& chains) const;

  // The same from root number `root`, one by one and without a copy: calls visit(const
  // SpecularChain&), whose argument lives until it returns.
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

  // For callers that need more than points: sequences of mirrors by number, shorter ones first.
  const ImageNode& node(std::uint32_t number) const { return nodes_[number]; }
  const Vec3d& image(std::size_t root, std::uint32_t node) const {
    return images_[node * roots_.size() + root].point;
  }
  // The beams of the nodes.
  const BeamIndex& beams() const { return *index_; }
  // Finds the points of reflection of node `leaf`; false when one is not on its surface.
  bool back_trace(std::size_t root,
                  std::uint32_t leaf,
                  const Vec3d& target,
                  SpecularChain& chain) const;
  // True if the chain is not blocked, or blocking is not tested.
  bool is_open(std::size_t root, const SpecularChain& chain, const Vec3d& target) const {
    return !clear_only_ || is_clear(root, chain, target);
  }

  const std::vector<Vec3d>& roots() const { return roots_; }
  std::size_t size() const { return nodes_.size(); }           // number of sequences of mirrors
  std::size_t bytes() const;                                   // memory so far
  CandidateGenerator generator() const { return generator_; }  // the generator used, not kAutomatic

 private:
  ImageTree(const Scene& scene,
            std::span<const Vec3d> roots,
            const TraceOptions& options,
            GrownTree grown);

  bool is_direct(std::size_t root, const Vec3d& target) const;  // the chain without mirrors
  std::vector<std::uint32_t> candidates(const Vec3d& target) const;
  // True if the mirrors of `node` make a chain; it is then in `chain`.
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
  bool clear_only_;  // blocked chains are left out
  CandidateGenerator generator_;
  std::vector<ImageNode> nodes_;  // by depth; parents before children
  std::vector<Image> images_;     // of every root, node by node
  std::shared_ptr<const BeamIndex> index_;
};

}  // namespace rayloc
