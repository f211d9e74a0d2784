#include "engine/scene/read/load_scene.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/scene/read/mesh_reader.h"
#include "engine/scene/read/scene_xml.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

Expected<std::string> read_file(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    return bad_input(file.string() +
                     (fs::exists(file, error) ? " is not a file" : " does not exist"));
  }
  std::ifstream in(file, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  if (!in) {
    return make_error(ErrorKind::kUnavailable, file.string() + " cannot be read");
  }
  return bytes;
}

// Upper bound of the stretch of any vector.
double largest_stretch(const Mat3d& m) {
  return std::sqrt(dot(m.row0, m.row0) + dot(m.row1, m.row1) + dot(m.row2, m.row2));
}

}  // namespace

Expected<Scene> parse_scene(std::string_view xml,
                            const std::string& xml_name,
                            const SceneOptions& options,
                            const ReadFile& read_mesh_file) {
  auto description = read_scene_xml(xml, xml_name, options);
  RAYLOC_TRY(description);
  Scene::Input input;
  input.carrier_hz = options.carrier_hz;
  input.materials = std::move(description->materials);
  input.notes = std::move(description->notes);
  for (ShapeDescription& shape : description->shapes) {
    if (!shape.mesh_file.empty()) {
      const auto bytes = read_mesh_file(shape.mesh_file);
      if (!bytes) {
        return make_error(bytes.error().kind,
                          shape.place + "shape '" + shape.name + "': " + bytes.error().message);
      }
      std::vector<SceneNote> notes;
      auto mesh = read_mesh(*bytes, shape.mesh_file, notes);
      if (!mesh) {
        return bad_input(shape.place + "shape '" + shape.name + "': " + mesh.error().message);
      }
      shape.mesh = std::move(*mesh);
      for (SceneNote& note : notes) {
        note.place = shape.place;
        note.message = "shape '" + shape.name + "': " + note.message;
        input.notes.push_back(std::move(note));
      }
    }
    for (Vec3d& vertex : shape.mesh.vertices) {
      vertex = shape.world_from_mesh.apply(vertex);
    }
    shape.mesh.rounding *= largest_stretch(shape.world_from_mesh.linear);
    input.objects.push_back({std::move(shape.name), std::move(shape.mesh), shape.material});
  }
  auto scene = Scene::create(std::move(input));
  if (!scene) {
    return make_error(scene.error().kind, xml_name + ": " + scene.error().message);
  }
  return scene;
}

Expected<Scene> load_scene(const fs::path& file, const SceneOptions& options) {
  const auto xml = read_file(file);
  RAYLOC_TRY(xml);
  return parse_scene(*xml, file.string(), options, [&](const std::string& name) {
    return read_file(file.parent_path() / name);
  });
}

}  // namespace rayloc
