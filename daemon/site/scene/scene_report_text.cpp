#include "daemon/site/scene/scene_report_text.h"

#include <array>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

namespace rayloc {
namespace {

using SceneJson = nlohmann::ordered_json;

const char* form_name(ObjectForm form) {
  constexpr std::array<const char*, 3> kNames = {"sheet", "closed", "open"};
  return kNames.at(static_cast<std::size_t>(form));
}

SceneJson json_of(const Bounds& bounds) {
  const auto vector = [](const Vec3d& v) { return SceneJson::array({v.x, v.y, v.z}); };
  return {{"min", vector(bounds.lower)}, {"max", vector(bounds.upper)}};
}

std::string material_table(const SceneReport& report) {
  std::string text = fmt::format("\n{:<22} {:>8} {:>12} {:>13} {:>8}\n",
                                 "material",
                                 "eps_r",
                                 "sigma [S/m]",
                                 "thickness [m]",
                                 "objects");
  for (const MaterialReport& each : report.materials) {
    text += fmt::format("{:<22} {:>8.4g} {:>12.4g} {:>13.4g} {:>8}\n",
                        each.material.name,
                        each.material.relative_permittivity,
                        each.material.conductivity,
                        each.material.thickness,
                        each.objects);
  }
  return text;
}

std::string object_table(const SceneReport& report) {
  std::string text = fmt::format("\n{:<22} {:<18} {:<7} {:>8} {:>9}  {}\n",
                                 "object",
                                 "material",
                                 "form",
                                 "surfaces",
                                 "triangles",
                                 "from x, y, z to x, y, z [m]");
  for (const ObjectReport& object : report.objects) {
    const Vec3d& low = object.bounds.lower;
    const Vec3d& high = object.bounds.upper;
    text += fmt::format(
        "{:<22} {:<18} {:<7} {:>8} {:>9}  {:.3f}, {:.3f}, {:.3f} to {:.3f}, {:.3f}, {:.3f}\n",
        object.name,
        object.material,
        form_name(object.form),
        object.surfaces,
        object.triangles,
        low.x,
        low.y,
        low.z,
        high.x,
        high.y,
        high.z);
  }
  return text;
}

}  // namespace

std::string scene_report_json(const SceneSource& source, const SceneReport& report) {
  const Scene& scene = *source.scene;
  SceneJson json = {{"name", source.name},
                    {"frequency", scene.carrier_hz()},
                    {"bounds", json_of({scene.bounds_min(), scene.bounds_max()})},
                    {"surfaces", scene.surfaces().size()},
                    {"triangles", scene.triangle_count()},
                    {"dropped_triangles", report.dropped_triangles},
                    {"contacts", report.contacts},
                    {"materials", SceneJson::array()},
                    {"objects", SceneJson::array()},
                    {"warnings", SceneJson::array()},
                    {"errors", SceneJson::array()}};
  for (const MaterialReport& each : report.materials) {
    json["materials"].push_back({{"name", each.material.name},
                                 {"relative_permittivity", each.material.relative_permittivity},
                                 {"conductivity", each.material.conductivity},
                                 {"thickness", each.material.thickness},
                                 {"objects", each.objects}});
  }
  for (const ObjectReport& object : report.objects) {
    json["objects"].push_back({{"name", object.name},
                               {"material", object.material},
                               {"form", form_name(object.form)},
                               {"surfaces", object.surfaces},
                               {"triangles", object.triangles},
                               {"bounds", json_of(object.bounds)}});
  }
  for (const SceneWarning& warning : report.warnings) {
    json["warnings"].push_back({{"kind", warning.kind}, {"message", warning.message}});
  }
  for (const SceneWarning& error : report.errors) {
    json["errors"].push_back({{"kind", error.kind}, {"message", error.message}});
  }
  // Names come from the scene file: invalid UTF-8 is replaced.
  return json.dump(-1, ' ', false, SceneJson::error_handler_t::replace) + "\n";
}

std::string scene_report_text(const SceneSource& source, const SceneReport& report) {
  const Scene& scene = *source.scene;
  const Vec3d size = scene.bounds_max() - scene.bounds_min();
  std::string text = fmt::format(
      "{}: {:.3f} x {:.3f} x {:.3f} m, {} objects, {} surfaces, {} triangles, at {:.6g} GHz\n",
      source.name,
      size.x,
      size.y,
      size.z,
      report.objects.size(),
      scene.surfaces().size(),
      scene.triangle_count(),
      scene.carrier_hz() / 1e9);
  text += material_table(report) + object_table(report);
  text += fmt::format("\n{} pairs of faces touch and hide each other\n", report.contacts);
  for (const SceneWarning& warning : report.warnings) {
    text += "warning: " + warning.message + "\n";
  }
  return text + (report.warnings.empty() && report.errors.empty() ? "no warning\n" : "");
}

}  // namespace rayloc
