// `rayloc scene import`: makes a scene, and the site
// around it, from a drawing or scan of another program.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene_verbs.h"
#include "daemon/site/import/drawn_plan.h"
#include "daemon/site/import/import_scene.h"
#include "daemon/site/import/recognise.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/access_point_presets.h"
#include "daemon/site/scene/room_site.h"
#include "engine/base/printable.h"
#include "engine/base/suggestion.h"

namespace rayloc::cli {
namespace {

struct Unit {
  std::string_view name;
  double metres;
};
constexpr std::array kUnits = {
    Unit{"mm", 0.001}, Unit{"cm", 0.01}, Unit{"m", 1.0}, Unit{"in", 0.0254}, Unit{"ft", 0.3048}};

struct SceneImportArguments {
  std::string file;
  std::string out;
  std::string name;
  std::string materials;
  std::string unit;
  std::string up;
  std::string model;
  std::optional<double> scale;
  std::optional<double> height;
  std::optional<double> tolerance;
  bool print_materials = false;
  bool force = false;
  bool quiet = false;
};

Expected<ImportOptions> import_options(const SceneImportArguments& arguments) {
  ImportOptions options;
  if (!arguments.unit.empty()) {
    const auto unit = std::find_if(
        kUnits.begin(), kUnits.end(), [&](const Unit& one) { return one.name == arguments.unit; });
    if (unit == kUnits.end()) {
      return make_error(ErrorKind::kUsage,
                        "--unit: '" + arguments.unit + "' is none of mm, cm, m, in, ft");
    }
    options.units.metres = unit->metres;
  }
  if (!arguments.up.empty()) {
    if (arguments.up != "y" && arguments.up != "z") {
      return make_error(ErrorKind::kUsage, "--up: '" + arguments.up + "' is neither y nor z");
    }
    options.units.up = arguments.up[0];
  }
  if (arguments.scale) {
    if (!arguments.unit.empty()) {
      return make_error(ErrorKind::kUsage,
                        "--scale states the scale of a drawing on paper, --unit the unit of the "
                        "file; write one of them");
    }
    constexpr double kMost = 1000.0;  // scale of site plans
    if (!(*arguments.scale >= 1.0 && *arguments.scale <= kMost)) {
      return make_error(ErrorKind::kUsage, "--scale: write 50 for 1:50, from 1 to 1000");
    }
    options.units.scale = *arguments.scale;
  }
  if (arguments.height) {
    constexpr double kMost = 20.0;  // [m], height of a hall
    if (!(*arguments.height > kHead && *arguments.height <= kMost)) {
      return make_error(ErrorKind::kUsage,
                        "--height: write metres, above 2.1 (the top of windows) and up to 20");
    }
    options.units.height = *arguments.height;
  }
  if (arguments.tolerance) {
    constexpr double kMost = 0.5;  // [m]; more would join opposite sides of furniture
    if (!(*arguments.tolerance > 0.0 && *arguments.tolerance <= kMost)) {
      return make_error(ErrorKind::kUsage, "--tolerance: write metres, above 0 and up to 0.5");
    }
    options.tolerance = *arguments.tolerance;
  }
  return options;
}

Expected<void> write_imported(const SceneImportArguments& arguments,
                              const ImportedScene& imported) {
  const std::filesystem::path directory = arguments.out;
  if (auto prepared = prepare_output(directory, arguments.force); !prepared) {
    return prepared;
  }
  RoomPlan plan;
  plan.name = arguments.name.empty() ? "room" : arguments.name;
  plan.lower = imported.bounds.lower;
  plan.upper = imported.bounds.upper;
  plan.carrier = usual_carrier();
  auto files = scene_files(imported.scene);
  files["site.toml"] = room_site(plan, arguments.model);
  for (const auto& [name, content] : files) {
    if (auto written = write_file(directory / name, content); !written) {
      return written;
    }
  }
  return {};
}

Expected<void> run_scene_import(const SceneImportArguments& arguments) {
  if (arguments.print_materials) {
    std::fputs(kDefaultMaterialTable, stdout);
    return {};
  }
  if (arguments.file.empty() || arguments.out.empty()) {
    return make_error(ErrorKind::kUsage, "write FILE and --out, or --print-materials");
  }
  const auto options = import_options(arguments);
  if (!options) {
    return tl::make_unexpected(options.error());
  }
  const auto table = arguments.materials.empty()
                         ? MaterialTable::parse(kDefaultMaterialTable, "materials")
                         : MaterialTable::read(arguments.materials);
  if (!table) {
    return report_file_error(table.error());
  }
  const auto imported = import_scene(arguments.file, *table, *options);
  if (!imported) {
    return report_file_error(imported.error());
  }
  if (auto written = write_imported(arguments, *imported); !written) {
    return written;
  }
  if (!arguments.quiet) {
    const Vec3d size = imported->bounds.size();
    std::fprintf(stderr,
                 "%s: %zu objects of %zu materials, %.2f x %.2f x %.2f m\n",
                 arguments.out.c_str(),
                 imported->scene.objects.size(),
                 imported->scene.materials.size(),
                 size.x,
                 size.y,
                 size.z);
    for (const std::string& remark : imported->remarks) {
      std::fprintf(stderr, "  %s\n", printable(remark, '\n').c_str());
    }
  }
  return {};
}

}  // namespace

RunVerb declare_scene_import(OptionParser& app) {
  const auto arguments = std::make_shared<SceneImportArguments>();
  app.add_option("FILE", arguments->file, kFormats);
  app.add_option("--out", arguments->out, "Directory for scene.xml, meshes/ and site.toml");
  app.add_option("--name", arguments->name, "Name of the site; default: room");
  app.add_option("--materials", arguments->materials, "Table of names and radio materials, TOML");
  app.add_flag("--print-materials", arguments->print_materials, "Print the default table");
  app.add_option("--unit", arguments->unit, "Unit of the file: mm, cm, m, in or ft");
  app.add_option(
      "--scale", arguments->scale, "Scale of an SVG that was drawn for paper: 50 for 1:50");
  app.add_option("--up", arguments->up, "Which axis of the file points up: y or z");
  app.add_option(
      "--height", arguments->height, "Floor to ceiling of a flat drawing [m]; default: 2.7");
  app.add_option("--tolerance",
                 arguments->tolerance,
                 "How far a scan may be from its planes [m]; default: thrice its roughness");
  app.add_option("--access-point", arguments->model, "Write an access point of that model")
      ->check(one_of(preset_models()));
  app.add_flag("--force", arguments->force, "Write into a directory that is not empty");
  app.add_flag("--quiet", arguments->quiet, "Print nothing when all is well");
  app.footer(
      "Example:\n  rayloc scene import scan.glb --out office\n"
      "  rayloc scene import storey.dxf --height 2.8 --out office\n"
      "  rayloc scene import plan.svg --scale 50 --out office\n"
      "  rayloc scene import room.json --out office\n"
      "  rayloc scene import --print-materials > materials.toml\n"
      "  rayloc scene import house.obj --unit cm --up z --materials materials.toml --out house");
  return [arguments] { return run_scene_import(*arguments); };
}

}  // namespace rayloc::cli
