// scene_hash: a hash of the scene's content: names, geometry, materials, carrier. Data made for a
// scene (a calibration, a path grid) are valid for that hash alone.
#pragma once

#include <string>

namespace rayloc {

class Scene;

std::string scene_hash(const Scene& scene);

}  // namespace rayloc
