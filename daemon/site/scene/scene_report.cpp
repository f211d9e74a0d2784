#include "daemon/site/scene/scene_report.h"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/model/room_match.h"
#include "daemon/site/scene/rough_mesh.h"
#include "daemon/site/scene/solid_around.h"
#include "daemon/site/scene/surface_overlap.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

Bounds bounds_of(const Scene& scene) { return {scene.bounds_min(), scene.bounds_max()}; }

std::vector<ObjectReport> report_objects(const Scene& scene) {
  std::vector<ObjectReport> reports;
  for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
    const SceneObject& object = scene.objects()[i];
    ObjectReport report;
    report.name = printable(object.name);
    report.material = printable(scene.materials()[object.material].name);
    report.triangles = object.mesh.triangles.size();
    report.bounds = bounds_of(object.mesh);
    reports.push_back(std::move(report));
  }
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    ++reports[scene.owner(i).object].surfaces;
  }
  for (std::uint32_t i = 0; i < reports.size(); ++i) {
    const bool flat = reports[i].surfaces == 1;
    reports[i].form = flat                        ? ObjectForm::kSheet
                      : scene.solid(i).shells > 0 ? ObjectForm::kClosed
                                                  : ObjectForm::kOpen;
  }
  return reports;
}

std::vector<MaterialReport> report_materials(const Scene& scene) {
  std::vector<MaterialReport> reports;
  for (const RadioMaterial& material : scene.materials()) {
    reports.push_back({material, 0});
  }
  for (const SceneObject& object : scene.objects()) {
    ++reports[object.material].objects;
  }
  return reports;
}

// Sheets with two faces each, which intentionally enclose no volume.
bool is_drawn_from_both_sides(const Scene& scene, std::uint32_t object) {
  const auto [first, end] = scene.surfaces_of(object);
  for (std::uint32_t i = first; i < end; ++i) {
    if (scene.owner(i).one_facing) {
      return false;
    }
  }
  return true;
}

void warn_of_objects(const Scene& scene,
                     const std::vector<ObjectReport>& objects,
                     std::vector<SceneWarning>& warnings) {
  const Bounds all = bounds_of(scene);
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    const ObjectReport& object = objects[i];
    const bool is_shell = norm(object.bounds.lower - all.lower) < kSameBounds &&
                          norm(object.bounds.upper - all.upper) < kSameBounds;
    if (object.form == ObjectForm::kClosed && scene.solid(i).orientation < 0 && !is_shell) {
      warnings.push_back({"inside_out",
                          fmt::format("object '{}' is turned inside out: its triangles face "
                                      "inwards; turn their corners round",
                                      object.name)});
    }
    if (is_rough_mesh(scene.objects()[i].mesh)) {
      warnings.push_back(
          {"rough_scan",
           fmt::format("object '{}' has {} surfaces of {} triangles: its walls are rough, as those "
                       "of a scan, and each triangle is a mirror of its own; simplify it (Blender: "
                       "Decimate, Planar), or make planes of its mesh: rayloc scene import",
                       object.name,
                       object.surfaces,
                       object.triangles)});
    } else if (object.form == ObjectForm::kOpen && !is_drawn_from_both_sides(scene, i)) {
      warnings.push_back(
          {"open_body",
           fmt::format("object '{}' has {} surfaces and no inside: a face is missing, turned round "
                       "or does not meet its neighbours; a box needs all six",
                       object.name,
                       object.surfaces)});
    }
  }
}

// Counts contacts; a doubled face is a warning.
std::size_t report_overlaps(const Scene& scene, std::vector<SceneWarning>& warnings) {
  std::size_t contacts = 0;
  for (const SurfaceOverlap& overlap : find_overlaps(scene)) {
    if (!overlap.doubled) {
      ++contacts;
      continue;
    }
    warnings.push_back(
        {"overlap",
         fmt::format("objects '{}' and '{}' share {:.3g} m^2 of one plane; it is undefined "
                     "which of them a wave meets: move one by a millimetre, or cut a hole",
                     printable(scene.objects()[scene.owner(overlap.first).object].name),
                     printable(scene.objects()[scene.owner(overlap.second).object].name),
                     overlap.area)});
  }
  return contacts;
}

void warn_of_antenna(const Scene& scene,
                     const SiteAntenna& antenna,
                     std::vector<SceneWarning>& warnings) {
  if (const auto around = solid_around(scene, antenna.place)) {
    warnings.push_back({"antenna_inside",
                        fmt::format("{} is inside of object '{}', where it receives nothing",
                                    antenna.name,
                                    printable(scene.objects()[*around].name))});
  }
}

}  // namespace

SceneReport inspect_scene(const SceneSource& source) {
  const Scene& scene = *source.scene;
  SceneReport report;
  report.objects = report_objects(scene);
  report.materials = report_materials(scene);
  for (const SceneNote& note : scene.notes()) {
    report.warnings.push_back({note.kind, note.place + note.message});
  }
  report.dropped_triangles = scene.dropped_triangles();
  if (report.dropped_triangles > 0) {
    report.warnings.push_back(
        {"degenerate_triangle",
         fmt::format("{} triangles without area were left out", report.dropped_triangles)});
  }
  warn_of_objects(scene, report.objects, report.warnings);
  report.contacts = report_overlaps(scene, report.warnings);
  if (source.site) {
    for (const SiteAntenna& antenna : antennas_of(*source.site)) {
      warn_of_antenna(scene, antenna, report.warnings);
    }
  }
  for (RoomFinding& finding : room_findings(scene, source.site ? &*source.site : nullptr)) {
    (finding.is_error ? report.errors : report.warnings)
        .push_back({std::move(finding.kind), std::move(finding.message)});
  }
  return report;
}

}  // namespace rayloc
