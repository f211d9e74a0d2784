// scanned_room: converts scanned boxes of walls, openings and furniture to a model.
#pragma once

#include <string>
#include <vector>

#include "daemon/site/import/model.h"
#include "engine/base/expected.h"
#include "engine/base/outline.h"
#include "engine/base/vec3.h"

namespace rayloc {

// For a wall x is along it, y up and z across it.
struct ScannedBox {
  std::string name;  // kind: "wall", "window", "table"
  std::string id;
  std::string parent;  // id of the wall that contains an opening
  Vec3d centre;        // [m], z up
  Vec3d x, y, z;       // unit vectors of its axes
  Vec3d size;          // [m] along these
  bool is_open = false;
};

struct ScannedRoom {
  std::vector<ScannedBox> walls;
  std::vector<ScannedBox> openings;
  std::vector<ScannedBox> objects;
  std::vector<FloorPoint> floor;  // [m], an outline; empty: the rectangle around the walls
};

// Returns an Error if there is no wall. Parts that could not be placed are in the remarks.
Expected<Model> scanned_room(ScannedRoom room);

}  // namespace rayloc
