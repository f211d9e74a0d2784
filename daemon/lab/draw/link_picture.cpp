#include "daemon/lab/draw/link_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "engine/trace/path_tracer.h"

namespace rayloc::draw {
namespace {

std::vector<Mark> access_point_marks(const Site& site) {
  std::vector<Mark> marks;
  for (const SiteAccessPoint& ap : site.access_points) {
    Mark mark{ap.id, MarkKind::kAccessPoint, {}, {}};
    for (std::size_t i = 0; i < ap.array.element_offset.size(); ++i) {
      mark.antennas.push_back(element_position(ap.array, i));
    }
    mark.heading = rotation(ap.array.pose.orientation) * Vec3d{1.0, 0.0, 0.0};
    if (!mark.antennas.empty()) {
      marks.push_back(std::move(mark));
    }
  }
  return marks;
}

std::vector<DrawnPath> drawn_paths(const Paths& paths, const DrawnLink& link) {
  std::vector<DrawnPath> drawn;
  for (const Path& path : paths) {
    if (!(abs2(path.a) > 0.0)) {
      continue;
    }
    DrawnPath line{{link.transmitter.position}, 10.0 * std::log10(abs2(path.a))};
    for (const Interaction& interaction : path.interactions) {
      line.points.push_back(interaction.position);
    }
    line.points.push_back(link.receiver.position);
    drawn.push_back(std::move(line));
  }
  return drawn;
}

}  // namespace

ScenePicture source_picture(const SceneSource& source) {
  const Scene& scene = *source.scene;
  const Vec3d size = scene.bounds_max() - scene.bounds_min();
  ScenePicture picture;
  picture.scene = &scene;
  picture.title = source.name;
  picture.caption = fmt::format("{:.2f} x {:.2f} x {:.2f} m, {} objects, {:.4g} GHz",
                                size.x,
                                size.y,
                                size.z,
                                scene.objects().size(),
                                scene.carrier_hz() / 1e9);
  if (source.site) {
    picture.marks = access_point_marks(*source.site);
    for (const SiteZone& zone : source.site->zones) {
      picture.zones.push_back({zone.name, zone.polygon});
    }
  }
  return picture;
}

void add_link(const DrawnLink& link, const SceneSource& source, ScenePicture& picture) {
  const Paths paths = PathTracer(source.scene, link.options).trace(link.transmitter, link.receiver);
  picture.paths = drawn_paths(paths, link);
  for (const DrawnPath& path : picture.paths) {
    picture.strongest_db = &path == &picture.paths.front()
                               ? path.power_db
                               : std::max(picture.strongest_db, path.power_db);
  }
  picture.weakest_db = picture.strongest_db - link.range_db;
  std::erase_if(picture.paths,
                [&](const DrawnPath& path) { return path.power_db < picture.weakest_db; });
  picture.caption += fmt::format(", {} paths to depth {}", paths.size(), link.options.max_depth);
  if (picture.paths.size() < paths.size()) {
    picture.caption +=
        fmt::format(", {} within {:g} dB are drawn", picture.paths.size(), link.range_db);
  }
  if (link.marks_transmitter) {
    picture.marks.push_back({"tx", MarkKind::kTransmitter, {link.transmitter.position}, {}});
  }
  if (link.marks_receiver) {
    picture.marks.push_back({"rx", MarkKind::kReceiver, {link.receiver.position}, {}});
  }
}

}  // namespace rayloc::draw
