// Maps: the plan of a room, and numbers in it as colours.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "daemon/draw/drawing.h"
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

struct MapName {  // of a colour, where values are numbers of things
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
  std::vector<MapCell> cells;  // under everything else but the plan
  std::vector<MapLine> lines;
  double line_width = 4.0;  // [pixel]
  std::vector<MapDot> dots;
  std::vector<MapAntenna> antennas;
  std::string ring_meaning;  // of MapDot::ringed, for the legend; empty: none are
  // The colours and what they mean.
  std::string value_name;
  double lowest = 0.0;  // REQUIRES: lowest < highest
  double highest = 1.0;
  std::function<Colour(double share)> colour;  // 0: lowest, 1: highest
  std::vector<MapName> names;                  // in place of the scale of colours
};

// REQUIRES: map.scene != nullptr, map.colour.
Drawing draw_room_map(const RoomMap& map);

}  // namespace rayloc::draw
