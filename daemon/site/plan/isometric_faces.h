// The faces of a room for an isometric picture, with shading, in painting order.
//
// The ceiling, and thin objects at the viewer's sides,
// would hide the room: only their edges are drawn.
#pragma once

#include <vector>

#include "daemon/site/plan/drawing.h"
#include "daemon/site/plan/face.h"
#include "daemon/site/plan/scene_parts.h"
#include "engine/base/vec3.h"

namespace rayloc::draw {

struct LitFace {
  Face face;
  Colour colour;
};

struct IsometricFaces {
  std::vector<LitFace> filled;  // from the back to the front
  std::vector<Face> open;
};

// For a viewer in the direction `towards_viewer`, on the side of the smallest x and y.
IsometricFaces isometric_faces(std::vector<Face> faces,
                               const std::vector<ScenePart>& parts,
                               const Vec3d& towards_viewer);

}  // namespace rayloc::draw
