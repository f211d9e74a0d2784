// inspect_scene: the contents of a scene, and its probable errors.
//
// An unusable scene (a missing mesh, a vertex that is no number, an unknown
// material) is an error of load_scene. A warning is about a scene that can
// be traced and whose channels would differ from those of the real place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "daemon/site/scene/scene_source.h"
#include "engine/em/radio_material.h"
#include "engine/scene/bounds.h"

namespace rayloc {

// kSheet: in one plane; kClosed: a body with an inside; kOpen: neither, or a body with shells that
// are inconsistent about the inside.
enum class ObjectForm : std::uint8_t { kSheet, kClosed, kOpen };

struct ObjectReport {
  std::string name;
  std::string material;
  ObjectForm form = ObjectForm::kSheet;
  std::size_t surfaces = 0;
  std::size_t triangles = 0;
  Bounds bounds;  // [m]
};

struct MaterialReport {
  RadioMaterial material;  // at the carrier
  std::size_t objects = 0;
};

struct SceneWarning {
  std::string kind;     // "overlap": for scripts
  std::string message;  // for people
};

struct SceneReport {
  std::vector<ObjectReport> objects;      // in the order of the file
  std::vector<MaterialReport> materials;  // in the same order
  std::size_t dropped_triangles = 0;
  std::size_t contacts = 0;  // pairs of faces that touch and hide each other
  // The kinds are: left_out, material, rotation_axis, mesh_count, mesh_materials (of reading:
  // SceneNote), degenerate_triangle, inside_out, open_body, rough_scan, overlap, antenna_inside,
  // and those of room_findings().
  std::vector<SceneWarning> warnings;
  std::vector<SceneWarning> errors;  // of room_findings(): this is not the room of the site
};

SceneReport inspect_scene(const SceneSource& source);

}  // namespace rayloc
