#include "daemon/site/import/import_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/drawn_plan.h"
#include "daemon/site/import/dxf/dxf_reader.h"
#include "daemon/site/import/listed.h"
#include "daemon/site/import/planes.h"
#include "daemon/site/import/read_model.h"
#include "daemon/site/import/recognise.h"
#include "daemon/site/import/room_scan.h"
#include "daemon/site/import/svg_reader.h"

namespace rayloc {
namespace {

constexpr double kLevelCosine = 0.8;    // chosen: 37 degrees, for a floor or ceiling
constexpr double kUprightCosine = 0.3;  // chosen: 17 degrees, for a wall
constexpr double kNearEnd = 0.4;        // [m], chosen: to the lowest or highest point
constexpr double kWallHeight = 1.5;     // [m], chosen: lower objects are furniture
constexpr double kLargestRead = 250.0;  // [m], chosen: scenes are rooms and storeys
constexpr double kSmallestRead = 1.0;   // [m], chosen: smaller than any room
constexpr double kPoorShare = 0.7;      // of a scan's area, chosen: less has holes or is no room

// Names that were given, each with the next number for a repeated one.
using GivenNames = std::map<std::string, int>;

// The letters, digits, '-' and '_' of a name, made unique.
std::string object_name(const std::string& name, GivenNames& names) {
  std::string base;
  for (const char c : name) {
    const std::string one(1, c);
    base += is_object_name(one) ? one : "_";
  }
  base = base.empty() ? "part" : base;
  const auto [given, is_new] = names.try_emplace(base, 2);
  std::string unique = base;
  while (!is_new && !names.try_emplace(unique, 2).second) {
    unique = base + "_" + std::to_string(given->second++);
  }
  return unique;
}

// Kind of a face or a flat part, from its position.
std::string part_by_place(double normal_z, const Bounds& own, const Bounds& whole) {
  if (std::abs(normal_z) > kLevelCosine) {
    if (own.upper.z < whole.lower.z + kNearEnd) {
      return "floor";
    }
    return own.lower.z > whole.upper.z - kNearEnd ? "ceiling" : "other";
  }
  return std::abs(normal_z) < kUprightCosine && own.size().z > kWallHeight ? "wall" : "other";
}

// Normal of a drawn part: along its shortest extent.
double flat_normal_z(const Bounds& bounds) {
  const Vec3d size = bounds.size();
  return size.z <= std::min(size.x, size.y) ? 1.0 : 0.0;
}

class SceneMaker {
 public:
  SceneMaker(const MaterialTable& table, const ImportOptions& options, const Model& model)
      : table_(table), options_(options), whole_(bounds_of(model)) {
    std::size_t dense = 0;
    std::size_t all = 0;
    for (const ModelPart& part : model.parts) {
      all += part.mesh.triangles.size();
      dense += is_dense(part.mesh) ? part.mesh.triangles.size() : 0;
    }
    is_scan_ = 2 * dense > all;
  }

  void add(const ModelPart& part) {
    const auto known = table_.find(part.material, part.name);
    if (!known && !(part.name.empty() && part.material.empty())) {
      unknown_.insert(part.name.empty() ? part.material : part.name);
    }
    if (is_dense(part.mesh, is_scan_)) {
      add_scan(part, known);
      return;
    }
    const Bounds bounds = bounds_of(part.mesh);
    StatedMaterial material =
        known ? *known : table_.otherwise(part_by_place(flat_normal_z(bounds), bounds, whole_));
    material.thickness = part.thickness > 0.0 ? part.thickness : material.thickness;
    add_object(part.name, material, part.mesh);
  }

  Expected<ImportedScene> finish() {
    if (scan_triangles_ > 0 && scan_area_ > 0.0) {
      result_.remarks.push_back(
          fmt::format("{} triangles of scans became {} planes, which hold {:.0f} % of their area; "
                      "the planes are {:.1f} mm off the scan (rms), within a tolerance of {:.0f} "
                      "mm (--tolerance states another)",
                      scan_triangles_,
                      planes_,
                      100.0 * kept_area_ / scan_area_,
                      1e3 * std::sqrt(squares_ / std::max(kept_area_, 1e-12)),
                      1e3 * tolerance_));
    }
    if (result_.scene.objects.empty()) {
      return bad_input(
          "no plane could be found in the scan; give a wider --tolerance, or export "
          "it with more triangles");
    }
    if (kept_area_ < kPoorShare * scan_area_) {
      result_.remarks.emplace_back(
          "warning: much of the scan is in no plane: it has holes or is very rough; unseen "
          "surfaces are left out of the scene");
    }
    if (!unknown_.empty()) {
      result_.remarks.push_back(
          fmt::format("no row of the table of materials is of {}; they are taken by where they are "
                      "(--materials names a table)",
                      listed(unknown_)));
    }
    std::sort(result_.scene.materials.begin(),
              result_.scene.materials.end(),
              [](const StatedMaterial& a, const StatedMaterial& b) { return a.name < b.name; });
    result_.bounds = {};
    for (const StatedObject& object : result_.scene.objects) {
      const Bounds own = bounds_of(object.mesh);
      result_.bounds.include(own.lower);
      result_.bounds.include(own.upper);
    }
    return std::move(result_);
  }

 private:
  void add_object(const std::string& name, const StatedMaterial& material, const Mesh& mesh) {
    auto& materials = result_.scene.materials;
    // The same material with two thicknesses is two materials.
    std::string material_name = material.name;
    const auto same = [&](const StatedMaterial& other) {
      return other.itu == material.itu && other.thickness == material.thickness &&
             other.relative_permittivity == material.relative_permittivity &&
             other.conductivity == material.conductivity;
    };
    const auto found = std::find_if(materials.begin(), materials.end(), same);
    if (found != materials.end()) {
      material_name = found->name;
    } else {
      material_name = object_name(material.name, material_names_);
      materials.push_back(material);
      materials.back().name = material_name;
    }
    result_.scene.objects.push_back({object_name(name, names_), material_name, mesh});
  }

  void add_scan(const ModelPart& part, const std::optional<StatedMaterial>& known) {
    const ScanPlanes found = find_planes(part.mesh, options_.tolerance);
    scan_triangles_ += part.mesh.triangles.size();
    scan_area_ += found.area;
    kept_area_ += found.kept_area;
    planes_ += found.planes.size();
    tolerance_ = std::max(tolerance_, found.tolerance);
    Mesh together;
    for (const ScanPlane& plane : found.planes) {
      squares_ += plane.area * plane.error * plane.error;
      if (!known) {
        const std::string kind = part_by_place(plane.normal.z, bounds_of(plane.mesh), whole_);
        add_object(kind == "other" ? "surface" : kind, table_.otherwise(kind), plane.mesh);
        continue;
      }
      const auto first = static_cast<std::uint32_t>(together.vertices.size());
      together.vertices.insert(
          together.vertices.end(), plane.mesh.vertices.begin(), plane.mesh.vertices.end());
      for (const auto& [a, b, c] : plane.mesh.triangles) {
        together.triangles.push_back({first + a, first + b, first + c});
      }
    }
    if (!together.triangles.empty()) {
      add_object(part.name, *known, together);
    }
  }

  const MaterialTable& table_;
  const ImportOptions& options_;
  Bounds whole_;
  bool is_scan_ = false;
  ImportedScene result_;
  GivenNames names_;
  GivenNames material_names_;
  std::set<std::string> unknown_;
  std::size_t scan_triangles_ = 0;
  std::size_t planes_ = 0;
  double scan_area_ = 0.0;  // [m^2]
  double kept_area_ = 0.0;
  double squares_ = 0.0;  // [m^4]: squared errors, weighted by area
  double tolerance_ = 0.0;
};

Expected<Model> model_of_drawing(const std::filesystem::path& file,
                                 ModelFormat format,
                                 const MaterialTable& table,
                                 const ModelUnits& units) {
  const auto drawing = format == ModelFormat::kSvg ? read_svg(file, units) : read_dxf(file);
  RAYLOC_TRY(drawing);
  auto model = drawn_plan(*drawing, table, {units.metres, units.height});
  return model ? std::move(model) : bad_input(file.string() + ": " + model.error().message);
}

}  // namespace

Expected<ImportedScene> scene_of(const Model& model,
                                 const MaterialTable& table,
                                 const ImportOptions& options) {
  SceneMaker maker(table, options, model);
  for (const ModelPart& part : model.parts) {
    maker.add(part);
  }
  auto made = maker.finish();
  if (made) {
    made->remarks.insert(made->remarks.begin(), model.remarks.begin(), model.remarks.end());
  }
  return made;
}

Expected<ImportedScene> import_scene(const std::filesystem::path& file,
                                     const MaterialTable& table,
                                     const ImportOptions& options) {
  const auto format = recognise(file);
  RAYLOC_TRY(format);
  if (options.units.scale > 0.0 && *format != ModelFormat::kSvg) {
    return bad_input(file.string() + ": is " + name_of(*format) +
                     ", which is as large as it was drawn; --scale is of SVG, --unit of this");
  }
  const bool is_flat = *format == ModelFormat::kDxf || *format == ModelFormat::kSvg;
  if (!table.named_walls().empty() && !is_flat) {
    return bad_input(file.string() + ": is " + name_of(*format) +
                     ", whose walls are objects; --walls is of the layers of DXF and SVG");
  }
  auto model = is_flat ? model_of_drawing(file, *format, table, options.units)
               : *format == ModelFormat::kRoomScan ? read_room_scan(file)
                                                   : read_model(file, *format, options.units);
  RAYLOC_TRY(model);
  // The height of a flat drawing is stated, and not drawn.
  const Vec3d size = bounds_of(*model).size();
  const double longest = std::max({size.x, size.y, is_flat ? 0.0 : size.z});
  if (!(longest <= kLargestRead)) {
    return bad_input(fmt::format(
        "{}: would be {:.0f} m long, and scenes are rooms and storeys of {:.0f} m at most; state "
        "its unit (--unit mm), or export a part of it",
        file.string(),
        longest,
        kLargestRead));
  }
  if (longest < kSmallestRead) {
    return bad_input(
        fmt::format("{}: would be {:.2g} m long, and rooms are larger; state its unit (--unit m)",
                    file.string(),
                    longest));
  }
  if (longest > kLargestStorey) {
    model->remarks.push_back(fmt::format(
        "warning: it is {:.0f} m long; if that is too much, state its unit (--unit mm)", longest));
  }
  model->remarks.insert(model->remarks.begin(), name_of(*format));
  auto made = scene_of(*model, table, options);
  return made ? std::move(made) : bad_input(file.string() + ": " + made.error().message);
}

}  // namespace rayloc
