// Maps: the plan of a room, with values as colours.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "daemon/site/plan/drawing.h"
#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc::draw {

struct MapDot {
  Vec3d at;  // [m]
  double value = 0.0;
  bool ringed = false;
};

struct MapLine {  // a surface, seen from above
  Vec3d from;     // [m]
  Vec3d to;
  double value = 0.0;
};

struct MapCell {      // a square of the floor
  Vec3d middle;       // [m]
  double side = 0.0;  // [m]
  double value = 0.0;
};

struct MapName {  // name of a colour, if values are numbers of things
  std::string name;
  Colour colour;
};

struct MapAntenna {
  std::string name;
  Vec3d at;  // [m]
};

struct RoomMap {
  const Scene* scene = nullptr;
  std::string title;
  std::vector<MapCell> cells;  // drawn over the plan and under all other parts
  std::vector<MapLine> lines;
  double line_width = 4.0;  // [pixel]
  std::vector<MapDot> dots;
  std::vector<MapAntenna> antennas;
  std::string ring_meaning;  // of MapDot::ringed, for the legend; empty: no rings
  // The colours and their meaning.
  std::string value_name;
  double lowest = 0.0;  // REQUIRES: lowest < highest
  double highest = 1.0;
  std::function<Colour(double share)> colour;  // 0: lowest, 1: highest
  std::vector<MapName> names;                  // replace the colour scale
};

// REQUIRES: map.scene != nullptr, map.colour.
Drawing draw_room_map(const RoomMap& map);

}  // namespace rayloc::draw
