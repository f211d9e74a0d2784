// A scene as files: Mitsuba XML and PLY meshes, as read by Sionna RT and load_scene.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"
#include "engine/em/radio_material.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// A radio material as stated by a scene file: a row of ITU-R P.2040-4, evaluated by the reader of
// the file at its frequency, or two numbers.
struct StatedMaterial {
  std::string name;
  std::string itu;  // empty: use the numbers
  double relative_permittivity = 1.0;
  double conductivity = 0.0;             // [S/m]
  double thickness = kDefaultThickness;  // [m]
  SurfaceScattering scattering = {};
};

// True if an object or a material can have that name, which becomes a part of ids and of file
// names: letters, digits, '-' and '_'.
bool is_object_name(std::string_view text);

struct StatedObject {
  std::string name;
  std::string material;  // name of a StatedMaterial
  Mesh mesh;
};

struct StatedScene {
  std::vector<StatedMaterial> materials;
  std::vector<StatedObject> objects;
};

// Content by file name: "scene.xml", "meshes/NAME.ply" ("meshes/object.N.ply" for a name that is no
// object name). Vertices are written so that they read back as the same doubles.
std::map<std::string, std::string> scene_files(const StatedScene& scene);

}  // namespace rayloc
