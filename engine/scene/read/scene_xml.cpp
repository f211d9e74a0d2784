#include "engine/scene/read/scene_xml.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <pugixml.hpp>

#include "engine/base/suggestion.h"
#include "engine/scene/read/material_xml.h"
#include "engine/scene/read/visual_names.h"
#include "engine/scene/read/xml_defaults.h"
#include "engine/scene/read/xml_element.h"
#include "engine/scene/read/xml_file.h"

namespace rayloc {
namespace {

constexpr std::string_view kMeshPrefix = "mesh-";  // prefix of ids from Mitsuba's exporters

// Mitsuba's [-1, 1]^2 in the plane z = 0, and [-1, 1]^3.
Mesh rectangle_mesh() {
  return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}
Mesh cube_mesh() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        {(i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : -1.0});
  }
  // Anticlockwise seen from outside.
  mesh.triangles = {{0, 2, 3},
                    {0, 3, 1},
                    {4, 5, 7},
                    {4, 7, 6},
                    {0, 1, 5},
                    {0, 5, 4},
                    {2, 6, 7},
                    {2, 7, 3},
                    {0, 4, 6},
                    {0, 6, 2},
                    {1, 3, 7},
                    {1, 7, 5}};
  return mesh;
}

class SceneReader {
 public:
  SceneReader(XmlFile& file, const SceneOptions& options)
      : file_(file), options_(options), materials_(file, options, bsdfs_, scene_.notes) {}

  Expected<SceneDescription> read(const pugi::xml_node& root) {
    apply_defaults(file_, root);
    check_scene(root);
    for (const pugi::xml_node& shape : root.children("shape")) {
      read_shape(shape);
    }
    complain_of_instances();
    if (scene_.shapes.empty() && instances_ == 0) {
      file_.complain(root,
                     left_out_.empty()
                         ? "the scene has no <shape>; a room needs at least one"
                         : "every <shape> of the scene is a lamp or has a null material; a room "
                           "needs at least one that waves meet");
    }
    RAYLOC_TRY(file_.check());
    RAYLOC_TRY(check_overrides());
    add_notes();
    return std::move(scene_);
  }

 private:
  // Registers elements with an id, and reports elements that are neither read nor left out.
  void check_scene(const pugi::xml_node& root) {
    XmlElement element(file_, root, "scene");
    for (const pugi::xml_attribute& attribute : root.attributes()) {
      const std::string_view name = attribute.name();
      if (name.starts_with("xml") || name.starts_with("xsi:")) {
        element.attribute(name);
      }
    }
    for (const char* name : {"version", "type", "id", "name"}) {
      element.attribute(name);
    }
    element.allow_tags({"default", "bsdf", "shape", "include", "path", "alias"});
    element.allow_tags(visual_tags());
    element.finish();
    for (const pugi::xml_node& child : root.children()) {
      const std::string_view tag = child.name();
      const std::string id = child.attribute("id").value();
      if (tag == "include" || tag == "path" || tag == "alias") {
        file_.complain(child,
                       "<" + std::string(tag) + "> is not supported; " +
                           (tag == "path" ? "write the folder into each filename"
                                          : "write its content into this file"));
      } else if (tag == "bsdf") {
        add_bsdf(child, id);
      } else if (is_listed(visual_tags(), tag) && !id.empty()) {
        visual_ids_[id] = tag;
      }
    }
  }

  void add_bsdf(const pugi::xml_node& bsdf, const std::string& id) {
    if (id.empty()) {
      file_.complain(bsdf, "this <bsdf> has no id, so that no shape can have it");
      return;
    }
    const auto [first, added] = bsdfs_.emplace(id, bsdf);
    if (!added) {
      file_.complain(bsdf,
                     "two <bsdf>s have the id '" + id + "'; the first is at " +
                         without_colon(file_.place(first->second)));
    }
  }

  static std::string without_colon(std::string place) {
    place.erase(place.size() - 2);
    return place;
  }

  void read_shape(const pugi::xml_node& node) {
    if (is_of_instances(node)) {
      first_instance_ = first_instance_ ? first_instance_ : node;
      ++instances_;
      return;
    }
    const std::string name = name_of(node);
    if (const std::string why = why_left_out(node); !why.empty()) {
      left_out_ += (left_out_.empty() ? "'" : ", '") + name + "' (" + why + ")";
      left_out_at_ = left_out_at_.empty() ? file_.place(node) : left_out_at_;
      return;
    }
    XmlElement element(file_, node, "shape '" + name + "'");
    ShapeDescription shape;
    shape.name = name;
    shape.place = file_.place(node);
    element.attribute("id");
    element.attribute("name");
    const bool has_mesh = read_mesh(element, shape);
    if (!has_mesh && !is_readable(element.attribute("type"))) {
      scene_.shapes.emplace_back();
      return;  // its properties are specific to that type
    }
    if (const pugi::xml_node to_world = element.property("transform", "to_world")) {
      shape.world_from_mesh = read_transform(file_, to_world, odd_axes_);
    }
    const auto material = material_of_shape(node, name);
    element.allow_tags({"bsdf", "ref"});
    element.allow_tags(visual_tags());
    element.leave_out(is_visual_of_shape);
    element.finish();
    if (has_mesh && material) {
      shape.material = *material;
      scene_.shapes.push_back(std::move(shape));
    } else {
      scene_.shapes.emplace_back();  // there is a shape, with a complaint
    }
  }

  // "floor" of "mesh-floor"; made unique among shapes.
  std::string name_of(const pugi::xml_node& node) {
    const std::string_view id = node.attribute("id").value();
    std::string name(id.starts_with(kMeshPrefix) ? id.substr(kMeshPrefix.size()) : id);
    for (std::size_t i = scene_.shapes.size(); name.empty(); ++i) {
      if (!shapes_.contains("shape" + std::to_string(i))) {
        name = "shape" + std::to_string(i);
      }
    }
    const auto [first, added] = shapes_.emplace(name, node);
    if (!added) {
      file_.complain(node,
                     "two shapes are called '" + name + "'; the first is at " +
                         without_colon(file_.place(first->second)) +
                         "; leave one out, or give each an id of its own");
    }
    return name;
  }

  // Mitsuba's copies of shapes, by reference.
  static bool is_of_instances(const pugi::xml_node& shape) {
    const std::string_view type = shape.attribute("type").value();
    return type == "shapegroup" || type == "instance";
  }

  // Reported once per file: each of many copies has the same cause and the same remedy.
  void complain_of_instances() {
    if (instances_ > 0) {
      file_.complain(first_instance_,
                     "instances (shapegroup, instance) are not supported, and the scene has " +
                         std::to_string(instances_) +
                         " such shapes; make them real in Blender (Object > Apply > Make Instances "
                         "Real) and export the scene again");
    }
  }

  // The reason for leaving out a visual-only shape.
  std::string why_left_out(const pugi::xml_node& shape) const {
    bool is_lamp = !shape.child("emitter").empty();
    std::optional<BsdfKind> kind;
    const auto inspect = [&](const pugi::xml_node& bsdf) {
      const BsdfKind found = materials_.kind_of(bsdf);
      kind = kind == BsdfKind::kRadio ? *kind : found;
    };
    for (const pugi::xml_node& child : shape.children()) {
      const std::string_view tag = child.name();
      const std::string id = child.attribute("id").value();
      const auto named = bsdfs_.find(id);
      if (tag == "bsdf") {
        inspect(child);
      } else if (tag == "ref" && named != bsdfs_.end()) {
        inspect(named->second);
      } else if (tag == "ref") {
        const auto visual = visual_ids_.find(id);
        is_lamp = is_lamp || (visual != visual_ids_.end() && visual->second == "emitter");
        if (visual == visual_ids_.end()) {
          kind = BsdfKind::kRadio;  // of an unknown id: reported as a mistake
        }
      }
    }
    if (kind == BsdfKind::kRadio) {
      return {};
    }
    return is_lamp ? "a lamp" : kind == BsdfKind::kNull ? "a null material" : "";
  }

  static bool is_readable(std::string_view type) {
    return type == "ply" || type == "obj" || type == "cube" || type == "rectangle";
  }

  bool read_mesh(XmlElement& element, ShapeDescription& shape) {
    const std::string type = element.attribute("type");
    if (type == "ply" || type == "obj") {
      shape.mesh_file = element.text("filename").value_or("");
      std::replace(shape.mesh_file.begin(), shape.mesh_file.end(), '\\', '/');  // of Windows
      if (shape.mesh_file.empty()) {
        element.complain("shape '" + shape.name + "' has no <string name=\"filename\">");
      }
      return !shape.mesh_file.empty();
    }
    if (type == "cube" || type == "rectangle") {
      shape.mesh = type == "cube" ? cube_mesh() : rectangle_mesh();
      return true;
    }
    element.complain("shape '" + shape.name + "' has type '" + type + "'; " +
                     (type == "merge" ? "write the shapes within it into the <scene> itself"
                                      : "ply, obj, cube and rectangle are supported"));
    return false;
  }

  // Index of the shape's material, which is evaluated on first use. Nothing where
  // there is a complaint.
  std::optional<std::uint32_t> material_of_shape(const pugi::xml_node& shape,
                                                 const std::string& name) {
    std::vector<pugi::xml_node> found;
    for (const pugi::xml_node& child : shape.children("bsdf")) {
      found.push_back(child);
    }
    bool is_known = true;
    for (const pugi::xml_node& reference : shape.children("ref")) {
      XmlElement element(file_, reference, {});
      const std::string id = element.attribute("id");
      element.attribute("name");
      element.finish();
      if (const auto bsdf = bsdfs_.find(id); bsdf != bsdfs_.end()) {
        found.push_back(bsdf->second);
      } else if (!visual_ids_.contains(id)) {
        is_known = false;
        element.complain("there is no <bsdf> with the id '" + id + "'" +
                         suggestion(id, known_ids()));
      }
    }
    if (found.size() > 1) {
      std::string ids;
      for (const pugi::xml_node& bsdf : found) {
        const std::string_view id = bsdf.attribute("id").value();
        ids += (ids.empty() ? "" : ", ") + (id.empty() ? "one without an id" : std::string(id));
      }
      file_.complain(shape,
                     "shape '" + name + "' has " + std::to_string(found.size()) + " materials (" +
                         ids +
                         "); it can be of one only: separate it by material in Blender, and "
                         "export a shape for each");
    }
    if (found.empty() && is_known) {
      file_.complain(
          shape,
          "shape '" + name + R"(' has no material; add <ref id="mat-itu_NAME" name="bsdf"/>)");
    }
    return found.empty() ? std::nullopt : material_of_bsdf(found.front(), name);
  }

  std::vector<std::string> known_ids() const {
    std::vector<std::string> ids;
    for (const auto& [id, node] : bsdfs_) {
      ids.push_back(id);
    }
    return ids;
  }

  std::optional<std::uint32_t> material_of_bsdf(const pugi::xml_node& bsdf,
                                                const std::string& user) {
    const auto [known, is_new] = evaluated_.try_emplace(bsdf.offset_debug());
    if (is_new) {
      if (auto material = materials_.read(bsdf, user)) {
        known->second = add_material(*std::move(material), bsdf);
      }
    }
    return known->second;
  }

  // Materials are identified by their names. Equal "mat-concrete" and "mat-itu_concrete" are one,
  // otherwise the second needs a separate name.
  std::uint32_t add_material(RadioMaterial material, const pugi::xml_node& bsdf) {
    const std::string name = material.name;
    auto& materials = scene_.materials;
    for (int number = 2;; ++number) {
      const auto same = std::find_if(materials.begin(), materials.end(), [&](const auto& one) {
        return one.name == material.name;
      });
      if (same == materials.end()) {
        break;
      }
      if (*same == material) {
        return static_cast<std::uint32_t>(same - materials.begin());
      }
      material.name = name + "_" + std::to_string(number);
    }
    if (material.name != name) {
      scene_.notes.push_back({"material",
                              file_.place(bsdf),
                              "a second material is called '" + name +
                                  "' and has other values: it goes by '" + material.name + "'"});
    }
    materials.push_back(std::move(material));
    return static_cast<std::uint32_t>(materials.size() - 1);
  }

  Expected<void> check_overrides() const {
    std::set<std::string> used;
    for (const RadioMaterial& material : scene_.materials) {
      used.insert(material.name);
    }
    for (const auto& [name, changed] : options_.materials) {
      if (!used.contains(name)) {
        return make_error(ErrorKind::kConfiguration,
                          file_.name() + ": values are stated for the material '" + name +
                              "', which no shape uses" +
                              suggestion(name, std::vector<std::string>(used.begin(), used.end())));
      }
    }
    return {};
  }

  void add_notes() {
    if (!left_out_.empty()) {
      scene_.notes.push_back(
          {"left_out", left_out_at_, "shapes that waves do not meet are left out: " + left_out_});
    }
    if (odd_axes_.count > 0) {
      scene_.notes.push_back(
          {"rotation_axis",
           odd_axes_.first,
           "the axis of this <rotate> has the length " + std::to_string(odd_axes_.length) +
               " instead of 1" +
               (odd_axes_.count > 1
                    ? ", and so have " + std::to_string(odd_axes_.count - 1) + " more"
                    : "") +
               ": the shape is rotated about it; Mitsuba and Sionna RT would deform it as well"});
    }
  }

  XmlFile& file_;
  const SceneOptions& options_;
  SceneDescription scene_;
  MaterialReader::Bsdfs bsdfs_;
  std::map<std::string, std::string> visual_ids_;  // tag of a visual-only element, by id
  std::map<std::string, pugi::xml_node> shapes_;   // by name
  std::map<std::ptrdiff_t, std::optional<std::uint32_t>> evaluated_;  // by place of the bsdf
  MaterialReader materials_;
  pugi::xml_node first_instance_;
  std::size_t instances_ = 0;
  std::string left_out_;
  std::string left_out_at_;
  OddAxes odd_axes_;
};

}  // namespace

Expected<SceneDescription> read_scene_xml(std::string_view xml,
                                          const std::string& xml_name,
                                          const SceneOptions& options) {
  XmlFile file(xml, xml_name);
  const auto root = file.parse();
  RAYLOC_TRY(root);
  return SceneReader(file, options).read(*root);
}

}  // namespace rayloc
