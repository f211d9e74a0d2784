// Planned points of a survey: positions for a device, each with a name for people.
//
// `x,y,z,name`: metres in the frame of the site. Written by `rayloc calibrate --plan`, read by
// `rayloc survey`; by hand the column `name` may be left out: the points are then p1, p2, ...
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"

namespace rayloc {

struct PlannedPoint {
  std::string name;
  Vec3d position;  // [m]
};

// In the order of the file; at least one. A repeated name is an error.
Expected<std::vector<PlannedPoint>> load_planned_points(const std::filesystem::path& file);

// The csv text, in whole millimetres.
std::string to_csv(std::span<const PlannedPoint> points);

}  // namespace rayloc
