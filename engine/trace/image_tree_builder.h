// Growing the images of an ImageTree, level by level, exhaustively: every mirror that geometry
// allows to follow another.
#pragma once

#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/beam_index.h"
#include "engine/trace/image_node.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct GrownTree {
  std::vector<ImageNode> nodes;   // by depth; those of one parent together, by surface
  std::vector<BeamBounds> beams;  // where the waves go after each node
};

// REQUIRES: options.max_depth >= 0. The same whatever the number of threads.
GrownTree grow_image_tree(const Scene& scene, const Vec3d& root, const TraceOptions& options);

}  // namespace rayloc
