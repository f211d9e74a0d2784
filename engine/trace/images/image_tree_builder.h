// Growing the images of an ImageTree, level by level: every mirror that geometry allows to follow
// another (exhaustive), or those of them that rays have met (shooting.h).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/images/beam_index.h"
#include "engine/trace/images/image_node.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct GrownTree {
  std::vector<ImageNode> nodes;   // by depth; those of one parent together, by surface
  std::vector<Image> images;      // of every root, node by node
  std::vector<BeamBounds> beams;  // where the waves go after each node, relative to the first root
  CandidateGenerator generator = CandidateGenerator::kExhaustive;  // that was used
};

// One tree for several roots; nothing where rays are to be shot, for their sequences are each
// root's own, nor where they might be for one of the roots alone. The same whatever the number of
// threads.
// REQUIRES: options.max_depth >= 0, 0 < roots.size() <= kMaxRoots.
std::optional<GrownTree> grow_exhaustively(const Scene& scene,
                                           std::span<const Vec3d> roots,
                                           const TraceOptions& options);

// kAutomatic: exhaustive unless the work for that, estimated from level to level, is more than
// about a tenth of a second on one core. The same whatever the number of threads.
// REQUIRES: options.max_depth >= 0, options.rays > 0.
GrownTree grow_image_tree(const Scene& scene, const Vec3d& root, const TraceOptions& options);

}  // namespace rayloc
