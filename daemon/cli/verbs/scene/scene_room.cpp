// `rayloc scene room`: makes a scene, and the site around it, from a plan of a few lines.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene/scene_verbs.h"
#include "daemon/site/import/recognise.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/access_point_presets.h"
#include "daemon/site/scene/build_room.h"
#include "daemon/site/scene/room_plan.h"
#include "daemon/site/scene/room_site.h"
#include "daemon/site/scene/scene_files.h"

namespace rayloc::cli {
namespace {

// The smallest plan; the complete format is in daemon/site/scene/room_plan.h.
constexpr const char* kExample = R"(Example:
  rayloc scene room office.toml --out office
  rayloc scene check office/scene.xml

office.toml (metres; materials of ITU-R P.2040-4):
  name = "office"
  size = [5.2, 3.4, 2.7]       # inside, along x, y, z
  floor = "concrete"
  ceiling = "ceiling_board"
  walls = "plasterboard"
  wall_north = "brick"         # also wall_west (-x), wall_east (+x), wall_south (-y)

  [[opening]]
  name = "door"
  wall = "east"
  centre = [1.0, 1.0]          # along the wall (its x or y), height
  size = [0.9, 2.0]
  material = "wood"            # left out: a hole

  [[box]]
  name = "table"
  material = "wood"
  centre = [2.0, 1.5, 0.73]
  size = [1.8, 0.9, 0.05]      # one of them may be 0: a sheet
  yaw_deg = 20

  [materials.plasterboard]     # 0.1 m thick unless stated; every face is one such slab
  thickness_m = 0.0125

A room of any outline, in place of `size`; its walls are wall_1, from corner 1 to corner 2, ...:
  outline = [[0, 0], [6, 0], [6, 4], [3, 5.5], [0, 4]]
  height = 2.7
  wall_3 = "glass"

  [[partition]]                # within the room, an opening may name it
  name = "partition"
  from = [3, 0]
  to = [3, 2.5]
  material = "plasterboard"

  [[slope]]                    # three points of a ceiling that slopes
  from = [0, 0, 1.2]
  to = [0, 4, 1.2]
  through = [2, 0, 2.7]

Several rooms are [[room]] tables with `name` and `outline`; their walls are kitchen_wall_1, ...

[carrier] and [[access_point]] may follow as in site.toml; with an access point the output is a
site, without one it lacks only that. --access-point writes one of a known model into a corner of
the room: state its position in site.toml.)";

struct SceneRoomArguments {
  std::string plan;
  std::string out;
  std::string model;
  bool force = false;
  bool quiet = false;
};

Expected<void> run_scene_room(const SceneRoomArguments& arguments) {
  if (const auto format = recognise(arguments.plan)) {
    return report_file_error({ErrorKind::kBadInput,
                              arguments.plan + ": is a drawing or scan (" + name_of(*format) +
                                  ") and no plan; make a scene of it with rayloc scene import"});
  }
  const Expected<RoomPlan> plan = load_room_plan(arguments.plan);
  if (!plan) {
    return report_file_error(plan.error());
  }
  if (!arguments.model.empty() && !plan->access_points.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--access-point: " + arguments.plan +
                          " has access points of its own; leave the option out");
  }
  const std::filesystem::path directory = arguments.out;
  RAYLOC_TRY(prepare_output(directory, arguments.force));
  const StatedScene scene = build_room(*plan);
  auto files = scene_files(scene);
  files["site.toml"] = room_site(*plan, arguments.model);
  for (const auto& [name, original] : room_pattern_files(*plan)) {
    auto content = read_file(original);
    RAYLOC_TRY(content);
    files[name] = *std::move(content);
  }
  for (const auto& [name, content] : files) {
    RAYLOC_TRY(write_file(directory / name, content));
  }
  if (!arguments.quiet) {
    std::fprintf(
        stderr,
        "%s: %zu objects of %zu materials; %s\n",
        directory.c_str(),
        scene.objects.size(),
        scene.materials.size(),
        !arguments.model.empty() ? "a site; state the position of the access point in its site.toml"
        : plan->access_points.empty() ? "to make it a site, name an access point in its site.toml"
                                      : "a site");
  }
  return {};
}

}  // namespace

RunVerb declare_scene_room(OptionParser& app) {
  const auto arguments = std::make_shared<SceneRoomArguments>();
  app.add_option("FILE", arguments->plan, "The plan of the room, TOML")->required();
  app.add_option("--out", arguments->out, "Directory for scene.xml, meshes/ and site.toml")
      ->required();
  app.add_option("--access-point", arguments->model, "Write an access point of that model")
      ->check(one_of(preset_models()));
  app.add_flag("--force", arguments->force, "Write into a directory that is not empty");
  app.add_flag("--quiet", arguments->quiet, "Print nothing when all is well");
  app.footer(kExample);
  return [arguments] { return run_scene_room(*arguments); };
}

}  // namespace rayloc::cli
