// `rayloc scene map`: maps received power and coverage over a room before any measurement.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/arguments/link_arguments.h"
#include "daemon/cli/arguments/number_list.h"
#include "daemon/cli/arguments/scene_notes.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene/scene_verbs.h"
#include "daemon/lab/predict/radio_map_report.h"
#include "daemon/lab/predict/radio_map_run.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_source.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

struct SceneMapArguments {
  std::string scene;
  std::optional<double> frequency;
  std::vector<std::string> access_points;
  std::vector<std::string> antennas;  // X,Y,Z
  std::optional<double> height;
  double step = 0.0;  // [m]; 0: for about 10,000 cells
  TraceOptions options;
  std::string out;
  bool force = false;
};

// The selected access points of the site, and antennas that are not mounted yet.
Expected<std::vector<NamedArray>> arrays_of(const SceneMapArguments& arguments,
                                            const SceneSource& source) {
  std::vector<NamedArray> arrays;
  if (!arguments.access_points.empty() || arguments.antennas.empty()) {
    auto of_site = mapped_access_points(source, arguments.access_points);
    if (!of_site) {
      return of_site;
    }
    arrays = *std::move(of_site);
  }
  for (const std::string& text : arguments.antennas) {
    const auto position = parse_point("--antenna", text);
    RAYLOC_TRY(position);
    arrays.push_back(planned_antenna(*position, arrays.size() + 1));
  }
  if (arrays.empty()) {
    return make_error(ErrorKind::kUsage,
                      source.name + " has no access point: give --antenna X,Y,Z in metres");
  }
  return arrays;
}

Expected<void> run_scene_map(const SceneMapArguments& arguments) {
  const auto source = load_scene_source(arguments.scene, arguments.frequency);
  if (!source) {
    return report_file_error(source.error());
  }
  auto arrays = arrays_of(arguments, *source);
  RAYLOC_TRY(arrays);
  const auto grid = mapped_grid(*source, arguments.height, arguments.step);
  RAYLOC_TRY(grid);
  RAYLOC_TRY(prepare_output(arguments.out, arguments.force));
  print_scene_notes(*source->scene);
  const RadioMaps maps = compute_radio_maps(*source, *std::move(arrays), *grid, arguments.options);
  std::fputs(printable(radio_map_table(maps), '\n').c_str(), stdout);
  return write_radio_maps(maps, *source->scene, arguments.out);
}

}  // namespace

RunVerb declare_scene_map(OptionParser& app) {
  const auto arguments = std::make_shared<SceneMapArguments>();
  declare_scene(app, arguments->scene, arguments->frequency);
  app.add_option("--out", arguments->out, "Folder to create: pictures as .png and .svg, arrays")
      ->required();
  app.add_option("--access-points", arguments->access_points, "Only these of the site");
  app.add_option("--antenna",
                 arguments->antennas,
                 "X,Y,Z [m]: an isotropic antenna there; several are compared. The site's access "
                 "points then only where --access-points names them");
  app.add_option("--height",
                 arguments->height,
                 "Height of the devices, world coordinate [m]; default: the site's, else 1.2 m "
                 "above the lowest point");
  app.add_option("--step", arguments->step, "Side of a cell [m]; default: about 10,000 cells")
      ->check(in_range(0.01, 100.0));
  declare_paths(app, arguments->options);
  app.add_flag("--force", arguments->force, "Write into a folder that is not empty");
  app.footer(
      "Path gain is received over sent power of an isotropic device: the sum over the paths' "
      "powers, without fading.\n"
      "Example:\n"
      "  rayloc scene map tests/data/sites/meeting_room --transmission --out coverage\n"
      "  rayloc scene map floor/scene.xml --antenna 2,3,2.4 --antenna 12,3,2.4 --out compared");
  return [arguments] { return run_scene_map(*arguments); };
}

}  // namespace rayloc::cli
