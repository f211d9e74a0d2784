// Model: content of another program's file, in metres and with z up.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/bounds.h"
#include "engine/scene/mesh.h"

namespace rayloc {

struct ModelPart {
  std::string name;      // of the object or layer, as in the file; may be empty
  std::string material;  // same
  Mesh mesh;
  double thickness = 0.0;  // [m], if the file states it
};

struct Model {
  std::vector<ModelPart> parts;
  std::vector<std::string> remarks;  // assumptions, as messages for a person: units, axes
};

// [m], chosen: size of a storey; larger numbers are in a smaller unit.
inline constexpr double kLargestStorey = 90.0;

Bounds bounds_of(const Model& model);

// Values that a person states for a file without them; 0: recognised or usual.
struct ModelUnits {
  double metres = 0.0;  // per unit of the file; 0: recognised
  char up = '\0';       // 'y' or 'z'; 0: recognised
  double height = 0.0;  // [m], floor to ceiling, for a flat drawing; 0: a usual one
  double scale = 0.0;   // for a drawing on paper: 50 for 1:50; 0: as drawn
};

}  // namespace rayloc
