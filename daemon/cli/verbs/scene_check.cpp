// `rayloc scene check`: prints the contents of a scene and its probable errors.
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene_verbs.h"
#include "daemon/site/scene/scene_report.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

using Json = nlohmann::ordered_json;

struct SceneCheckArguments {
  std::string scene;
  std::optional<double> frequency;
  bool json = false;
};

const char* to_string(ObjectForm form) {
  constexpr std::array<const char*, 3> kNames = {"sheet", "closed", "open"};
  return kNames.at(static_cast<std::size_t>(form));
}

Json json_of(const Bounds& bounds) {
  const auto vector = [](const Vec3d& v) { return Json::array({v.x, v.y, v.z}); };
  return {{"min", vector(bounds.lower)}, {"max", vector(bounds.upper)}};
}

std::string report_json(const SceneSource& source, const SceneReport& report) {
  const Scene& scene = *source.scene;
  Json json = {{"name", source.name},
               {"frequency", scene.carrier_hz()},
               {"bounds", json_of({scene.bounds_min(), scene.bounds_max()})},
               {"surfaces", scene.surfaces().size()},
               {"triangles", scene.triangle_count()},
               {"dropped_triangles", report.dropped_triangles},
               {"contacts", report.contacts},
               {"materials", Json::array()},
               {"objects", Json::array()},
               {"warnings", Json::array()},
               {"errors", Json::array()}};
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
                               {"form", to_string(object.form)},
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
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
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
        to_string(object.form),
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

std::string report_text(const SceneSource& source, const SceneReport& report) {
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

Expected<void> run_scene_check(const SceneCheckArguments& arguments) {
  const Expected<SceneSource> source = load_scene_source(arguments.scene, arguments.frequency);
  if (!source) {
    return report_file_error(source.error());
  }
  const SceneReport report = inspect_scene(*source);
  const std::string text =
      arguments.json ? report_json(*source, report) : report_text(*source, report);
  std::fputs(printable(text, '\n').c_str(), stdout);
  std::string errors;
  for (const SceneWarning& error : report.errors) {
    errors += (errors.empty() ? "" : "\n") + source->file.string() + ": " + error.message;
  }
  return errors.empty() ? Expected<void>()
                        : report_file_error({ErrorKind::kConfiguration, std::move(errors)});
}

}  // namespace

RunVerb declare_scene_check(OptionParser& app) {
  const auto arguments = std::make_shared<SceneCheckArguments>();
  app.add_option("SCENE", arguments->scene, "Mitsuba XML, or a site: a directory with site.toml")
      ->required();
  app.add_option("--frequency",
                 arguments->frequency,
                 "Carrier of the materials [Hz]; default: the site's, else 5.18e9");
  app.add_flag("--json", arguments->json, "One JSON object");
  app.footer(
      "Example:\n  rayloc scene check tests/data/sites/meeting_room\n"
      "  rayloc scene check office/scene.xml --frequency 2.437e9 --json");
  return [arguments] { return run_scene_check(*arguments); };
}

}  // namespace rayloc::cli
