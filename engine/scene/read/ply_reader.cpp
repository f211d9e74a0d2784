// A separate reader instead of assimp's, which keeps floats and reports no place in its errors.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/number_text.h"
#include "engine/scene/read/mesh_materials.h"
#include "engine/scene/read/mesh_reader.h"
#include "engine/scene/read/ply_body.h"
#include "engine/scene/read/ply_counts.h"
#include "engine/scene/read/ply_header.h"
#include "engine/scene/read/polygon_list.h"

namespace rayloc {
namespace {

constexpr double kFaceCorners = 3.0;  // at least

class MeshReader {
 public:
  MeshReader(std::string_view bytes, const std::string& name, const PlyHeader& header)
      : bytes_(bytes), name_(name), header_(header), body_(bytes, header) {}

  Expected<Mesh> read(std::vector<SceneNote>& notes) {
    const Expected<void> elements = read_elements();
    RAYLOC_TRY(check_counts(elements, notes));
    if (mesh_.vertices.empty() || faces_.size() == 0) {
      return bad_input(name_ + ": the mesh has no " + (mesh_.vertices.empty() ? "vertex" : "face"));
    }
    mesh_.rounding = std::max(mesh_.rounding, precision_.rounding());
    if (auto cut = faces_.append_to(mesh_, [&](std::size_t) { return name_; }); !cut) {
      return tl::make_unexpected(cut.error());
    }
    note_materials(materials_, name_, notes);
    return std::move(mesh_);
  }

 private:
  tl::unexpected<Error> refuse(const std::string& what) const {
    return bad_input(name_ + body_.place() + ": " + what);
  }

  Expected<void> read_elements() {
    for (const PlyElement& element : header_.elements) {
      // Each entry takes at least a byte per property: a larger count is invalid and
      // must not cost time.
      if (element.count >
          body_.bytes_left() / std::max<std::size_t>(element.properties.size(), 1)) {
        return refuse("the file is too short for " + std::to_string(element.count) +
                      " entries of element '" + element.name + "'");
      }
      std::vector<PlyUse> uses;
      for (const PlyProperty& property : element.properties) {
        uses.push_back(use_of(element, property));
      }
      for (std::size_t i = 0; i < element.count; ++i) {
        is_entry_begun_ = false;
        RAYLOC_TRY(read_entry(element, uses));
      }
    }
    return {};
  }

  // A file that ends too soon or too late, or that has entries as no exporter writes them, was read
  // with a wrong count: where one other count explains it, the message names that.
  Expected<void> check_counts(const Expected<void>& elements, std::vector<SceneNote>& notes) const {
    if (elements && body_.is_at_end() && is_regular_) {
      return {};
    }
    if (const auto miscount = find_miscount(bytes_, name_, header_)) {
      if (!miscount->is_left_over) {
        return bad_input(miscount->message);
      }
      notes.push_back({"mesh_count", {}, miscount->message});
      return elements;
    }
    if (!elements || body_.is_at_end()) {
      return elements;
    }
    if (!is_regular_) {
      return refuse("the counts of the header do not fit the body; export the mesh again");
    }
    notes.push_back({"mesh_count",
                     {},
                     name_ + body_.place() + ": " + std::to_string(body_.bytes_left()) +
                         " bytes follow the last entry that the header counts, and are left out"});
    return {};
  }

  std::optional<double> next(PlyType type) {
    const auto value = body_.next(type);
    is_regular_ = is_regular_ && (!body_.is_text() || body_.begins_line() != is_entry_begun_);
    is_entry_begun_ = true;
    return value;
  }

  Expected<void> read_entry(const PlyElement& element, std::span<const PlyUse> uses) {
    const bool is_vertex = element.name == "vertex";
    Vec3d vertex;
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.count_type) {
        RAYLOC_TRY(read_list(property, uses[i]));
        continue;
      }
      const auto value = next(property.type);
      if (!value) {
        return refuse("a number is missing for '" + property.name + "'");
      }
      if (uses[i] == PlyUse::kMaterial) {
        note_material(property, *value);
      }
      if (!is_vertex || uses[i] == PlyUse::kNone) {
        continue;
      }
      if (body_.is_text()) {
        precision_.note(body_.text(), *value);
      }
      (uses[i] == PlyUse::kX ? vertex.x : uses[i] == PlyUse::kY ? vertex.y : vertex.z) = *value;
    }
    if (is_vertex) {
      if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) {
        return refuse("vertex " + std::to_string(mesh_.vertices.size()) +
                      " has a coordinate that is not a finite number");
      }
      mesh_.vertices.push_back(vertex);
      return note_rounding(element, vertex);
    }
    return {};
  }

  void note_material(const PlyProperty& property, double value) {
    if (materials_.size() <= kMaxNamedMaterials) {
      materials_.insert(property.name + " " + std::to_string(std::llround(value)));
    }
  }

  // A float of a binary file has no more precision than its 24 bits.
  Expected<void> note_rounding(const PlyElement& element, const Vec3d& vertex) {
    // A ratio: half of the last bit of a float, 2^-24.
    constexpr double kFloatRounding = 5.9604644775390625e-8;
    constexpr double kCoarsest = 1e-3;  // [m], 6 degrees of phase at 5 GHz
    const bool is_float = std::any_of(
        element.properties.begin(), element.properties.end(), [&](const PlyProperty& property) {
          return property.type == PlyType::kFloat32 && use_of(element, property) != PlyUse::kNone;
        });
    if (!is_float || body_.is_text()) {
      return {};
    }
    const double furthest = std::max({std::abs(vertex.x), std::abs(vertex.y), std::abs(vertex.z)});
    mesh_.rounding = std::max(mesh_.rounding, kFloatRounding * furthest);
    if (mesh_.rounding > kCoarsest) {
      return refuse("a coordinate of vertex " + std::to_string(mesh_.vertices.size() - 1) + " is " +
                    std::to_string(std::llround(furthest)) +
                    " m, of which a float keeps no millimetres; export the mesh about a local "
                    "origin, or with coordinates of type double");
    }
    return {};
  }

  Expected<void> read_list(const PlyProperty& property, PlyUse use) {
    const auto count = next(*property.count_type);
    if (!count || !(*count >= 0.0) || *count > static_cast<double>(body_.bytes_left())) {
      return refuse("the length of '" + property.name + "' is missing or beyond the file");
    }
    if (*count != std::floor(*count)) {
      return refuse("the length of '" + property.name + "' is no whole number");
    }
    is_regular_ = is_regular_ && (use != PlyUse::kFace || *count >= kFaceCorners);
    std::vector<double> entries;
    const auto size = static_cast<std::size_t>(*count);
    for (std::size_t i = 0; i < size; ++i) {
      const auto value = next(property.type);
      if (!value) {
        return refuse("a number is missing in '" + property.name + "'");
      }
      const bool ends_strip = use == PlyUse::kStrips && *value == -1.0;
      if (use != PlyUse::kNone && !ends_strip &&
          (!(*value >= 0.0) || *value > 4'294'967'295.0 || *value != std::floor(*value))) {
        return refuse("a face refers to a vertex that is not a whole number from 0 on");
      }
      entries.push_back(*value);
    }
    if (use == PlyUse::kFace && !entries.empty()) {
      add_face(entries);
    } else if (use == PlyUse::kStrips) {
      add_strips(entries);
    }
    return {};
  }

  void add_face(std::span<const double> corners) {
    for (const double corner : corners) {
      faces_.add_corner(static_cast<std::uint32_t>(corner));
    }
    faces_.end_face();
  }

  // Each vertex after the second makes a triangle with the two before it, every other one with
  // reversed winding; -1 begins another strip. A vertex named twice only reverses the strip.
  void add_strips(std::span<const double> vertices) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i] == -1.0) {
        first = i + 1;
        continue;
      }
      if (i < first + 2) {
        continue;
      }
      const bool is_rotated = (i - first) % 2 == 1;
      const double a = vertices[i - (is_rotated ? 1 : 2)];
      const double b = vertices[i - (is_rotated ? 2 : 1)];
      if (a != b && b != vertices[i] && a != vertices[i]) {
        add_face(std::array{a, b, vertices[i]});
      }
    }
  }

  std::string_view bytes_;
  const std::string& name_;
  const PlyHeader& header_;
  PlyBody body_;
  bool is_entry_begun_ = false;
  // Text has one entry per line, and faces have corners.
  bool is_regular_ = true;
  Mesh mesh_;
  TextPrecision precision_;
  PolygonList faces_;
  std::set<std::string> materials_;  // of faces
};

}  // namespace

Expected<Mesh> read_ply(std::string_view bytes,
                        const std::string& name,
                        std::vector<SceneNote>& notes) {
  const auto header = read_ply_header(bytes, name);
  RAYLOC_TRY(header);
  return MeshReader(bytes, name, *header).read(notes);
}

}  // namespace rayloc
