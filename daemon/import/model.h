// Model: what a file of another program says of a place, in metres and with z up.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/bounds.h"
#include "engine/scene/mesh.h"

namespace rayloc {

struct ModelPart {
  std::string name;      // of the object or layer, as the file has it; may be empty
  std::string material;  // as much
  Mesh mesh;
  double thickness = 0.0;  // [m], where the file tells it
};

struct Model {
  std::vector<ModelPart> parts;
  std::vector<std::string> remarks;  // what was assumed, for a person: units, axes
};

// [m], chosen: of a storey, which numbers beyond it state in a smaller unit.
inline constexpr double kLargestStorey = 90.0;

Bounds bounds_of(const Model& model);

// What a person says of a file that does not tell; empty: recognised.
struct ModelUnits {
  double metres = 0.0;  // of a unit of the file; 0: recognised
  char up = '\0';       // 'y' or 'z'; 0: recognised
  double height = 0.0;  // [m], of floor to ceiling, of a flat drawing; 0: a usual one
  double scale = 0.0;   // of a drawing on paper: 50 for 1:50; 0: as it is drawn
};

}  // namespace rayloc
