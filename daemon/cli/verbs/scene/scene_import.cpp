// `rayloc scene import`: makes a scene, and the site
// around it, from a drawing or scan of another program.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene/scene_verbs.h"
#include "daemon/site/import/import_request.h"
#include "daemon/site/import/import_scene.h"
#include "daemon/site/import/imported_site.h"
#include "daemon/site/import/recognise.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/access_point_presets.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

struct SceneImportArguments {
  std::string file;
  std::string out;
  std::string name;
  std::string materials;
  std::vector<std::string> walls;
  std::string model;
  ImportRequest request;
  bool print_materials = false;
  bool force = false;
  bool quiet = false;
};

Expected<void> write_imported(const SceneImportArguments& arguments,
                              const ImportedScene& imported) {
  const std::filesystem::path directory = arguments.out;
  RAYLOC_TRY(prepare_output(directory, arguments.force));
  const std::string name = arguments.name.empty() ? "room" : arguments.name;
  for (const auto& [file, content] : imported_site_files(imported, name, arguments.model)) {
    RAYLOC_TRY(write_file(directory / file, content));
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
  const auto options = import_options(arguments.request);
  RAYLOC_TRY(options);
  auto table = arguments.materials.empty()
                   ? MaterialTable::parse(kDefaultMaterialTable, "materials")
                   : MaterialTable::read(arguments.materials);
  if (!table) {
    return report_file_error(table.error());
  }
  table->name_walls(arguments.walls);
  const auto imported = import_scene(arguments.file, *table, *options);
  if (!imported) {
    return report_file_error(imported.error());
  }
  RAYLOC_TRY(write_imported(arguments, *imported));
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
      std::fprintf(stderr, "  %s\n", printable(remark).c_str());
    }
    std::fprintf(stderr,
                 arguments.model.empty()
                     ? "to make it a site, name an access point in its site.toml\n"
                     : "a site; state the position of the access point in its site.toml\n");
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
  app.add_option("--walls",
                 arguments->walls,
                 "Layer of a flat drawing that holds walls, by its whole name; one for each option")
      ->allow_extra_args(false);
  app.add_flag("--print-materials", arguments->print_materials, "Print the default table");
  app.add_option("--unit", arguments->request.unit, "Unit of the file: mm, cm, m, in or ft");
  app.add_option(
      "--scale", arguments->request.scale, "Scale of an SVG that was drawn for paper: 50 for 1:50");
  app.add_option("--up", arguments->request.up, "Which axis of the file points up: y or z");
  app.add_option("--height",
                 arguments->request.height,
                 "Floor to ceiling of a flat drawing [m]; default: 2.7");
  app.add_option("--tolerance",
                 arguments->request.tolerance,
                 "How far a scan may be from its planes [m]; default: thrice its roughness");
  app.add_option("--access-point", arguments->model, "Write an access point of that model")
      ->check(one_of(preset_models()));
  app.add_flag("--force", arguments->force, "Write into a directory that is not empty");
  app.add_flag("--quiet", arguments->quiet, "Print nothing when all is well");
  app.footer(
      "Example:\n  rayloc scene import scan.glb --out office\n"
      "  rayloc scene import storey.dxf --height 2.8 --out office\n"
      "  rayloc scene import plan.svg --scale 50 --out office\n"
      "  rayloc scene import sketch.dxf --walls 0 --unit m --out office\n"
      "  rayloc scene import room.json --out office\n"
      "  rayloc scene import --print-materials > materials.toml\n"
      "  rayloc scene import house.obj --unit cm --up z --materials materials.toml --out house");
  return [arguments] { return run_scene_import(*arguments); };
}

}  // namespace rayloc::cli
