#include "daemon/lab/predict/radio_map_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/model/site.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

constexpr double kUsualCells = 10'000.0;      // count, chosen: resolution of a picture
constexpr std::size_t kMaxCells = 4'000'000;  // count, chosen: at most a gibibyte of memory
constexpr double kMinCellStep = 0.05;         // [m], chosen: finer cells add nothing (no phases)
constexpr double kUsualMapHeight = 1.2;       // [m], device height if no site states one

}  // namespace

Expected<std::vector<NamedArray>> mapped_access_points(const SceneSource& source,
                                                       const std::vector<std::string>& ids) {
  std::vector<NamedArray> arrays;
  if (source.site) {
    for (const std::string& id : ids) {
      if (const auto found = find_access_point(*source.site, id); !found) {
        return make_error(ErrorKind::kUsage, "--access-points: " + found.error().message);
      }
    }
    for (const SiteAccessPoint& ap : source.site->access_points) {
      if (ids.empty() || std::find(ids.begin(), ids.end(), ap.id) != ids.end()) {
        arrays.push_back({ap.id, ap.array});
      }
    }
  } else if (!ids.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--access-points: " + source.name +
                          " is a scene, which has none; give a site, or --antenna X,Y,Z");
  }
  return arrays;
}

NamedArray planned_antenna(const Vec3d& position, std::size_t number) {
  NamedArray one;
  one.name = "antenna " + std::to_string(number);
  one.array.pose.position = position;
  one.array.element_offset = {Vec3d{}};
  return one;
}

Expected<RadioMapGrid> mapped_grid(const SceneSource& source,
                                   std::optional<double> stated_height,
                                   double stated_step) {
  const bool stated = source.site && source.site->has_bounds;
  const Vec3d lower = stated ? source.site->bounds_min : source.scene->bounds_min();
  const Vec3d upper = stated ? source.site->bounds_max : source.scene->bounds_max();
  const double area = (upper.x - lower.x) * (upper.y - lower.y);
  const double step =
      stated_step > 0.0 ? stated_step : std::max(kMinCellStep, std::sqrt(area / kUsualCells));
  const double height =
      stated_height.value_or(source.site ? source.site->targets.height : lower.z + kUsualMapHeight);
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

RadioMaps compute_radio_maps(const SceneSource& source,
                             std::vector<NamedArray> arrays,
                             const RadioMapGrid& grid,
                             const TraceOptions& options,
                             const Observer& observer) {
  RadioMaps maps{source.name, grid, std::move(arrays), {}, {}};
  const PathTracer tracer(source.scene, options);
  for (const NamedArray& one : maps.arrays) {
    maps.maps.push_back(radio_map(tracer, one.array, grid));
    observer.progress(
        static_cast<double>(maps.maps.size()) / static_cast<double>(maps.arrays.size()), one.name);
  }
  maps.strongest = strongest_of(maps.maps);
  return maps;
}

}  // namespace rayloc
