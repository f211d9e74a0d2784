// scanned_room: walls, openings and furniture that a scanner saw as boxes, as a model.
#pragma once

#include <string>
#include <vector>

#include "daemon/import/model.h"
#include "engine/base/expected.h"
#include "engine/base/outline.h"
#include "engine/base/vec3.h"

namespace rayloc {

// Of a wall x is along it, y up and z across it.
struct ScannedBox {
  std::string name;  // what it is: "wall", "window", "table"
  std::string id;
  std::string parent;  // id of the wall that an opening is in
  Vec3d centre;        // [m], z up
  Vec3d x, y, z;       // its axes, of length 1
  Vec3d size;          // [m] along these
  bool is_open = false;
};

struct ScannedRoom {
  std::vector<ScannedBox> walls;
  std::vector<ScannedBox> openings;
  std::vector<ScannedBox> objects;
  std::vector<FloorPoint> floor;  // [m], an outline; empty: the rectangle around the walls
};

// An Error where there is no wall. What could not be placed is said in the remarks.
Expected<Model> scanned_room(ScannedRoom room);

}  // namespace rayloc
