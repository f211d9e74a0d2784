// Grows the images of an ImageTree, level by level: every mirror that geometry allows to follow
// another (exhaustive), or only those that rays have met (shooting.h).
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
  std::vector<ImageNode> nodes;   // by depth; children of one parent are adjacent, by surface
  std::vector<Image> images;      // of every root, node by node
  std::vector<BeamBounds> beams;  // beam of each node, relative to the first root
  CandidateGenerator generator = CandidateGenerator::kExhaustive;  // the generator used
};

// One tree for several roots; nothing where rays are to be shot, since their sequences differ
// between roots, or where rays might be shot for one of the roots alone. The result does not depend
// on the number of threads.
// REQUIRES: options.max_depth >= 0, 0 < roots.size() <= kMaxRoots.
std::optional<GrownTree> grow_exhaustively(const Scene& scene,
                                           std::span<const Vec3d> roots,
                                           const TraceOptions& options);

// kAutomatic: exhaustive unless the work for that, estimated from level to level, is more than
// about 0.1 s on one core. The result does not depend on the number of threads.
// REQUIRES: options.max_depth >= 0, options.rays > 0.
GrownTree grow_image_tree(const Scene& scene, const Vec3d& root, const TraceOptions& options);

}  // namespace rayloc
