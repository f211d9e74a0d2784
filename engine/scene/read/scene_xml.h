// The Mitsuba XML of a scene as plain values: shapes, not yet read, and their radio materials.
// Internal to load_scene.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"
#include "engine/em/radio_material.h"
#include "engine/scene/mesh.h"
#include "engine/scene/read/load_scene.h"
#include "engine/scene/read/transform_xml.h"
#include "engine/scene/scene_note.h"

namespace rayloc {

struct ShapeDescription {
  std::string name;
  std::string place;      // "scene.xml:12:5: ", for errors
  std::string mesh_file;  // with '/' between folders; empty: `mesh` is given
  Mesh mesh;              // of a cube or rectangle
  AffineTransform world_from_mesh;
  std::uint32_t material = 0;  // index into SceneDescription::materials
};

struct SceneDescription {
  std::vector<ShapeDescription> shapes;
  std::vector<RadioMaterial> materials;  // those used by shapes, at the carrier, overridden
  std::vector<SceneNote> notes;
};

Expected<SceneDescription> read_scene_xml(std::string_view xml,
                                          const std::string& xml_name,
                                          const SceneOptions& options);

}  // namespace rayloc
