// `rayloc scene map`: maps received power and coverage over a room before any measurement.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/cli/arguments/link_arguments.h"
#include "daemon/cli/arguments/number_list.h"
#include "daemon/cli/arguments/scene_notes.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene_verbs.h"
#include "daemon/lab/draw/picture_bytes.h"
#include "daemon/lab/predict/radio_map_report.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_source.h"
#include "engine/base/printable.h"
#include "engine/trace/path_tracer.h"

namespace rayloc::cli {
namespace {

constexpr double kUsualCells = 10'000.0;      // count, chosen: resolution of a picture
constexpr std::size_t kMaxCells = 4'000'000;  // count, chosen: at most a gibibyte of memory
constexpr double kMinCellStep = 0.05;         // [m], chosen: finer cells add nothing (no phases)
constexpr double kUsualMapHeight = 1.2;       // [m], device height if no site states one

struct SceneMapArguments {
  std::string scene;
  std::optional<double> frequency;
  std::vector<std::string> access_points;
  std::vector<std::string> antennas;  // X,Y,Z
  std::optional<double> height;
  double step = 0.0;  // [m]; 0: for about kUsualCells
  TraceOptions options;
  std::string out;
  bool force = false;
};

struct Picture {
  const char* name;
  RadioMapQuantity quantity;
};
constexpr std::array kPictures = {
    Picture{"path-gain", RadioMapQuantity::kPathGain},
    Picture{"delay-spread", RadioMapQuantity::kDelaySpread},
    Picture{"paths", RadioMapQuantity::kPathCount},
    Picture{"strongest", RadioMapQuantity::kStrongest},
};

Expected<NamedArray> antenna_at(const std::string& text, std::size_t number) {
  const auto position = parse_point("--antenna", text);
  if (!position) {
    return tl::make_unexpected(position.error());
  }
  NamedArray one;
  one.name = "antenna " + std::to_string(number);
  one.array.pose.position = *position;
  one.array.element_offset = {Vec3d{}};
  return one;
}

// The selected access points of the site, and antennas that are not mounted yet.
Expected<std::vector<NamedArray>> arrays_of(const SceneMapArguments& arguments,
                                            const SceneSource& source) {
  std::vector<NamedArray> arrays;
  if (source.site) {
    for (const std::string& id : arguments.access_points) {
      if (const auto found = find_access_point(*source.site, id); !found) {
        return make_error(ErrorKind::kUsage, "--access-points: " + found.error().message);
      }
    }
    const bool all = arguments.access_points.empty() && arguments.antennas.empty();
    for (const SiteAccessPoint& ap : source.site->access_points) {
      const auto& wanted = arguments.access_points;
      if (all || std::find(wanted.begin(), wanted.end(), ap.id) != wanted.end()) {
        arrays.push_back({ap.id, ap.array});
      }
    }
  } else if (!arguments.access_points.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--access-points: " + source.name +
                          " is a scene, which has none; give a site, or --antenna X,Y,Z");
  }
  for (const std::string& text : arguments.antennas) {
    auto one = antenna_at(text, arrays.size() + 1);
    if (!one) {
      return tl::make_unexpected(std::move(one.error()));
    }
    arrays.push_back(*std::move(one));
  }
  if (arrays.empty()) {
    return make_error(ErrorKind::kUsage,
                      source.name + " has no access point: give --antenna X,Y,Z in metres");
  }
  return arrays;
}

Expected<RadioMapGrid> grid_of(const SceneMapArguments& arguments, const SceneSource& source) {
  const bool stated = source.site && source.site->has_bounds;
  const Vec3d lower = stated ? source.site->bounds_min : source.scene->bounds_min();
  const Vec3d upper = stated ? source.site->bounds_max : source.scene->bounds_max();
  const double area = (upper.x - lower.x) * (upper.y - lower.y);
  const double step =
      arguments.step > 0.0 ? arguments.step : std::max(kMinCellStep, std::sqrt(area / kUsualCells));
  const double height = arguments.height.value_or(source.site ? source.site->targets.height
                                                              : lower.z + kUsualMapHeight);
  if (height < lower.z || height > upper.z) {
    return make_error(
        ErrorKind::kUsage,
        fmt::format(
            "--height {:g}: the room reaches from {:g} to {:g} m", height, lower.z, upper.z));
  }
  if (area / (step * step) > static_cast<double>(kMaxCells)) {
    return make_error(ErrorKind::kUsage,
                      fmt::format("--step {:g}: that would be {:.0f} cells, and {} are the most",
                                  step,
                                  area / (step * step),
                                  kMaxCells));
  }
  return radio_map_grid(lower, upper, height, step);
}

Expected<void> write_maps(const SceneMapArguments& arguments,
                          const RadioMaps& maps,
                          const Scene& scene) {
  const std::filesystem::path folder = arguments.out;
  for (const auto& [name, quantity] : kPictures) {
    if (quantity == RadioMapQuantity::kStrongest && maps.maps.size() == 1) {
      continue;
    }
    const draw::Drawing drawing = radio_map_picture(maps, scene, quantity);
    for (const char* ending : {".png", ".svg"}) {
      const std::string file = folder / (std::string(name) + ending);
      const auto bytes = draw::picture_bytes(drawing, file);
      if (!bytes) {
        return tl::make_unexpected(bytes.error());
      }
      if (auto written = write_file(file, *bytes); !written) {
        return written;
      }
    }
  }
  return write_npz(maps, folder / "radio-map.npz");
}

Expected<void> run_scene_map(const SceneMapArguments& arguments) {
  const auto source = load_scene_source(arguments.scene, arguments.frequency);
  if (!source) {
    return report_file_error(source.error());
  }
  auto arrays = arrays_of(arguments, *source);
  if (!arrays) {
    return tl::make_unexpected(arrays.error());
  }
  const auto grid = grid_of(arguments, *source);
  if (!grid) {
    return tl::make_unexpected(grid.error());
  }
  if (auto made = prepare_output(arguments.out, arguments.force); !made) {
    return made;
  }
  print_scene_notes(*source->scene);
  RadioMaps maps{source->name, *grid, *std::move(arrays), {}, {}};
  const PathTracer tracer(source->scene, arguments.options);
  for (const NamedArray& one : maps.arrays) {
    maps.maps.push_back(radio_map(tracer, one.array, *grid));
  }
  maps.strongest = strongest_of(maps.maps);
  std::fputs(printable(radio_map_table(maps), '\n').c_str(), stdout);
  return write_maps(arguments, maps, *source->scene);
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
