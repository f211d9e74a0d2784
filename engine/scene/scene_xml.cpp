#include "engine/scene/scene_xml.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <pugixml.hpp>

#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

constexpr std::string_view kMaterialPrefix = "mat-";
constexpr std::string_view kItuPrefix = "itu_";
constexpr std::string_view kMeshPrefix = "mesh-";
constexpr int kDeepestNesting = 8;  // of bsdfs in bsdfs

std::string_view without_prefix(std::string_view text, std::string_view prefix) {
  return text.substr(0, prefix.size()) == prefix ? text.substr(prefix.size()) : text;
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

// Numbers separated by blanks or commas; nothing when something else is among them.
std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,";
  std::vector<double> numbers;
  for (std::size_t begin = text.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
    const auto value = parse_number(text.substr(begin, end - begin));
    if (!value) {
      return std::nullopt;
    }
    numbers.push_back(*value);
    begin = text.find_first_not_of(kSeparators, end);
  }
  return numbers;
}

// The child <`tag` name="`name`" value="..."/>.
pugi::xml_node property(const pugi::xml_node& node, const char* tag, const char* name) {
  for (const pugi::xml_node& child : node.children(tag)) {
    if (std::string_view(child.attribute("name").value()) == name) {
      return child;
    }
  }
  return {};
}

AffineTransform operator*(const AffineTransform& a, const AffineTransform& b) {
  const Vec3d x = a.linear * Vec3d{b.linear.row0.x, b.linear.row1.x, b.linear.row2.x};
  const Vec3d y = a.linear * Vec3d{b.linear.row0.y, b.linear.row1.y, b.linear.row2.y};
  const Vec3d z = a.linear * Vec3d{b.linear.row0.z, b.linear.row1.z, b.linear.row2.z};
  return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}, a.apply(b.offset)};
}

// Rodrigues: by `angle` about the unit vector `k`.
Mat3d rotation_about(const Vec3d& k, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double m = 1.0 - c;
  return {{c + k.x * k.x * m, k.x * k.y * m - k.z * s, k.x * k.z * m + k.y * s},
          {k.y * k.x * m + k.z * s, c + k.y * k.y * m, k.y * k.z * m - k.x * s},
          {k.z * k.x * m - k.y * s, k.z * k.y * m + k.x * s, c + k.z * k.z * m}};
}

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

class XmlReader {
 public:
  XmlReader(std::string_view xml, const std::string& name, const SceneOptions& options)
      : xml_(xml), name_(name), options_(options) {}

  Expected<SceneDescription> read() {
    pugi::xml_document document;
    const pugi::xml_parse_result parsed =
        document.load_buffer(xml_.data(), xml_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed) {
      return bad_input(place(parsed.offset) +
                       "this is not well-formed XML: " + parsed.description());
    }
    const pugi::xml_node root = document.child("scene");
    if (!root) {
      return bad_input(name_ + ":1:1: the file has no <scene> element");
    }
    if (const pugi::xml_node include = root.child("include")) {
      return refuse(include, "<include> is not supported; write the shapes into this file");
    }
    for (const pugi::xml_node& bsdf : root.children("bsdf")) {
      bsdfs_.try_emplace(bsdf.attribute("id").value(), bsdf);
    }
    for (const pugi::xml_node& shape : root.children("shape")) {
      if (auto read = read_shape(shape); !read) {
        return tl::make_unexpected(read.error());
      }
    }
    if (scene_.shapes.empty()) {
      return refuse(root, "the scene has no <shape>; a room needs at least one");
    }
    if (auto used = check_overrides(); !used) {
      return tl::make_unexpected(used.error());
    }
    return std::move(scene_);
  }

 private:
  std::string place(std::ptrdiff_t offset) const {
    const auto end =
        std::min(xml_.size(), static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
    const std::string_view before = xml_.substr(0, end);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
    return name_ + ":" + std::to_string(line) + ":" + std::to_string(end - line_start + 1) + ": ";
  }
  // pugixml's offset is that of the name, one after the '<'.
  std::string place(const pugi::xml_node& node) const { return place(node.offset_debug() - 1); }

  tl::unexpected<Error> refuse(const pugi::xml_node& node, const std::string& what) const {
    return bad_input(place(node) + what);
  }

  Expected<std::optional<double>> number(const pugi::xml_node& node, const char* name) const {
    const pugi::xml_node child = property(node, "float", name);
    if (!child) {
      return std::nullopt;
    }
    const auto value = parse_number(child.attribute("value").value());
    if (!value) {
      return refuse(child,
                    std::string("'") + name + "' must be a number, not '" +
                        child.attribute("value").value() + "'");
    }
    return value;
  }

  Expected<void> read_shape(const pugi::xml_node& node) {
    ShapeDescription shape;
    shape.place = place(node);
    shape.name = without_prefix(node.attribute("id").value(), kMeshPrefix);
    if (shape.name.empty()) {
      shape.name = "shape" + std::to_string(scene_.shapes.size());
    }
    const std::string_view type = node.attribute("type").value();
    if (type == "ply" || type == "obj") {
      shape.mesh_file = property(node, "string", "filename").attribute("value").value();
      if (shape.mesh_file.empty()) {
        return refuse(node, "shape '" + shape.name + "' has no <string name=\"filename\">");
      }
    } else if (type == "cube") {
      shape.mesh = cube_mesh();
    } else if (type == "rectangle") {
      shape.mesh = rectangle_mesh();
    } else {
      return refuse(node,
                    "shape '" + shape.name + "' has type '" + std::string(type) +
                        "'; ply, obj, cube and rectangle are supported");
    }
    auto transform = read_transform(node);
    if (!transform) {
      return tl::make_unexpected(transform.error());
    }
    shape.world_from_mesh = *transform;
    auto material = material_of_shape(node, shape.name);
    if (!material) {
      return tl::make_unexpected(material.error());
    }
    shape.material = *material;
    scene_.shapes.push_back(std::move(shape));
    return {};
  }

  Expected<AffineTransform> read_transform(const pugi::xml_node& shape) const {
    AffineTransform world_from_mesh;
    for (const pugi::xml_node& step : property(shape, "transform", "to_world").children()) {
      if (step.type() != pugi::node_element) {
        continue;
      }
      const auto next = read_step(step);
      if (!next) {
        return tl::make_unexpected(next.error());
      }
      world_from_mesh = *next * world_from_mesh;  // in the order written
    }
    return world_from_mesh;
  }

  // A vector stated as value="x y z", value="s" or x="" y="" z="".
  Expected<Vec3d> read_vector(const pugi::xml_node& node, double missing) const {
    if (const pugi::xml_attribute value = node.attribute("value")) {
      const auto numbers = parse_numbers(value.value());
      if (numbers && numbers->size() == 1) {
        return Vec3d{(*numbers)[0], (*numbers)[0], (*numbers)[0]};
      }
      if (numbers && numbers->size() == 3) {
        return Vec3d{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
      }
      return refuse(node, "'value' must be one or three numbers");
    }
    std::array<double, 3> v{};
    const std::array<const char*, 3> names{"x", "y", "z"};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const pugi::xml_attribute attribute = node.attribute(names[i]);
      const auto value = attribute ? parse_number(attribute.value()) : missing;
      if (!value) {
        return refuse(node, std::string("'") + names[i] + "' must be a number");
      }
      v[i] = *value;
    }
    return Vec3d{v[0], v[1], v[2]};
  }

  Expected<AffineTransform> read_step(const pugi::xml_node& node) const {
    const std::string_view kind = node.name();
    AffineTransform step;
    if (kind == "matrix") {
      const auto m = parse_numbers(node.attribute("value").value());
      if (!m || m->size() != 16) {
        return refuse(node, "a <matrix> needs 16 numbers, row by row");
      }
      const auto& v = *m;
      return AffineTransform{{{v[0], v[1], v[2]}, {v[4], v[5], v[6]}, {v[8], v[9], v[10]}},
                             {v[3], v[7], v[11]}};
    }
    if (kind != "translate" && kind != "scale" && kind != "rotate") {
      return refuse(node,
                    "<" + std::string(kind) +
                        "> is not supported in a transform; translate, rotate, scale and "
                        "matrix are");
    }
    const auto vector = read_vector(node, kind == "scale" ? 1.0 : 0.0);
    if (!vector) {
      return tl::make_unexpected(vector.error());
    }
    if (kind == "translate") {
      step.offset = *vector;
    } else if (kind == "scale") {
      step.linear = {{vector->x, 0, 0}, {0, vector->y, 0}, {0, 0, vector->z}};
    } else {
      const auto degrees = parse_number(node.attribute("angle").value());
      const double length = norm(*vector);
      if (!degrees || !(length > 0.0)) {
        return refuse(node, "a <rotate> needs an axis and an 'angle' in degrees");
      }
      step.linear = rotation_about((1.0 / length) * *vector, *degrees * std::numbers::pi / 180.0);
    }
    return step;
  }

  // Index of the shape's material, which is evaluated when it is first met.
  Expected<std::uint32_t> material_of_shape(const pugi::xml_node& shape, const std::string& name) {
    if (const pugi::xml_node own = shape.child("bsdf")) {
      return material_of_bsdf(own, own.attribute("id").value());
    }
    for (const pugi::xml_node& reference : shape.children("ref")) {
      const std::string id = reference.attribute("id").value();
      if (const auto bsdf = bsdfs_.find(id); bsdf != bsdfs_.end()) {
        return material_of_bsdf(bsdf->second, id);
      }
      const std::string_view role = reference.attribute("name").value();
      if (role.empty() || role == "bsdf") {
        return refuse(reference,
                      "there is no <bsdf> with the id '" + id + "'" + suggestion(id, known_ids()));
      }
    }
    return refuse(shape,
                  "shape '" + name +
                      "' has no material; add <ref id=\"mat-itu_NAME\" "
                      "name=\"bsdf\"/>");
  }

  std::vector<std::string> known_ids() const {
    std::vector<std::string> ids;
    for (const auto& [id, node] : bsdfs_) {
      ids.push_back(id);
    }
    return ids;
  }

  Expected<std::uint32_t> material_of_bsdf(const pugi::xml_node& bsdf, const std::string& id) {
    const std::ptrdiff_t key = bsdf.offset_debug();
    if (const auto known = evaluated_.find(key); known != evaluated_.end()) {
      return known->second;
    }
    auto material = evaluate(bsdf, id);
    if (!material) {
      return tl::make_unexpected(material.error());
    }
    scene_.materials.push_back(std::move(*material));
    const auto index = static_cast<std::uint32_t>(scene_.materials.size() - 1);
    evaluated_.emplace(key, index);
    return index;
  }

  Expected<RadioMaterial> evaluate(const pugi::xml_node& outer, const std::string& id) {
    pugi::xml_node bsdf = outer;
    for (int depth = 0; depth < kDeepestNesting && bsdf.child("bsdf"); ++depth) {
      bsdf = bsdf.child("bsdf");  // twosided, mask, ...
    }
    const std::string_view bare = without_prefix(id, kMaterialPrefix);
    const std::string name(without_prefix(bare, kItuPrefix));
    const auto found = options_.materials.find(name);
    const RadioMaterialOverride changed =
        found != options_.materials.end() ? found->second : RadioMaterialOverride{};
    const bool complete = changed.relative_permittivity && changed.conductivity;

    Expected<RadioMaterial> material = RadioMaterial{name, 1.0, 0.0, kDefaultThickness};
    if (!complete) {
      material = stated_material(bsdf, bare, name);
    }
    if (!material) {
      return refuse(bsdf, "material '" + name + "': " + material.error().message);
    }
    const auto thickness = number(bsdf, "thickness");
    if (!thickness) {
      return tl::make_unexpected(thickness.error());
    }
    material->name = name;
    material->thickness = changed.thickness.value_or(thickness->value_or(kDefaultThickness));
    material->relative_permittivity =
        changed.relative_permittivity.value_or(material->relative_permittivity);
    material->conductivity = changed.conductivity.value_or(material->conductivity);
    if (auto valid = validate(*material); !valid) {
      return refuse(bsdf, valid.error().message);
    }
    return material;
  }

  // What the scene file itself says, without overrides; errors without a place.
  Expected<RadioMaterial> stated_material(const pugi::xml_node& bsdf,
                                          std::string_view bare_id,
                                          const std::string& name) const {
    const std::string_view type = bsdf.attribute("type").value();
    if (type == "radio-material") {
      const auto permittivity = number(bsdf, "relative_permittivity");
      const auto conductivity = number(bsdf, "conductivity");
      if (!permittivity || !conductivity) {
        return bad_input("relative_permittivity and conductivity must be numbers");
      }
      return RadioMaterial{name, permittivity->value_or(1.0), conductivity->value_or(0.0)};
    }
    if (type == "itu-radio-material") {
      return itu_material(property(bsdf, "string", "type").attribute("value").value(),
                          options_.carrier_hz);
    }
    if (bare_id.substr(0, kItuPrefix.size()) == kItuPrefix) {
      return itu_material(name, options_.carrier_hz);
    }
    return bad_input(
        "the <bsdf> says nothing about radio; use an id mat-itu_NAME with a name of ITU-R "
        "P.2040-3, the type radio-material, or state relative_permittivity and conductivity of "
        "the material '" +
        name + "' in the site");
  }

  Expected<void> check_overrides() const {
    std::vector<std::string> used;
    for (const RadioMaterial& material : scene_.materials) {
      used.push_back(material.name);
    }
    for (const auto& [name, changed] : options_.materials) {
      if (std::find(used.begin(), used.end(), name) == used.end()) {
        return make_error(ErrorKind::kConfiguration,
                          name_ + ": values are stated for the material '" + name +
                              "', which no shape uses" + suggestion(name, used));
      }
    }
    return {};
  }

  std::string_view xml_;
  const std::string& name_;
  const SceneOptions& options_;
  std::map<std::string, pugi::xml_node> bsdfs_;
  std::map<std::ptrdiff_t, std::uint32_t> evaluated_;  // by place of the bsdf
  SceneDescription scene_;
};

}  // namespace

Expected<SceneDescription> read_scene_xml(std::string_view xml,
                                          const std::string& xml_name,
                                          const SceneOptions& options) {
  return XmlReader(xml, xml_name, options).read();
}

}  // namespace rayloc
