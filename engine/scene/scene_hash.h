// scene_hash: tells scenes apart by content: names, geometry, materials, carrier. What was made for
// a scene (a calibration, a path grid) is valid for that hash alone.
#pragma once

#include <string>

namespace rayloc {

class Scene;

std::string scene_hash(const Scene& scene);

}  // namespace rayloc
