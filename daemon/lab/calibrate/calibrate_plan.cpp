#include "daemon/lab/calibrate/calibrate_plan.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/calibrate/fit_observer.h"
#include "daemon/lab/draw/scene_picture.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_notes.h"
#include "daemon/site/scene/solid_around.h"
#include "engine/base/printable.h"
#include "engine/calibrate/survey_plan.h"

namespace rayloc {
namespace {

// Points at one height hardly constrain the height of the access points: every third point is above
// or below, alternately. The others are at fix height and determine how certain fixes may be.
constexpr std::size_t kOtherHeight = 3;
constexpr double kOffHeight = 0.6;  // [m]
constexpr double kClearance = 0.3;  // [m], from floor and ceiling

bool is_possible(const RoomModel& room, const Vec3d& p) {
  return p.z > room.bounds_min.z + kClearance && p.z < room.bounds_max.z - kClearance &&
         !solid_around(*room.scene, p);
}

std::vector<PlannedPoint> named(const RoomModel& room, const std::vector<Vec3d>& points) {
  std::vector<PlannedPoint> planned;
  double step = kOffHeight;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3d place = points[i];
    if ((i + 1) % kOtherHeight == 0) {
      for (const double off : {step, -step}) {
        const Vec3d other{place.x, place.y, place.z + off};
        if (is_possible(room, other)) {
          place = other;
          step = -off;
          break;
        }
      }
    }
    planned.push_back({fmt::format("p{:02}", i + 1), place});
  }
  return planned;
}

// Objects with a surface whose reflections some access point receives at too few points.
PlanCoverage coverage_of(const SurveyPlan& plan, const RoomModel& room, std::size_t wanted) {
  PlanCoverage coverage{plan.candidates, plan.sightings.size(), 0, wanted, {}};
  std::map<std::string, const SurfaceSightings*> weak;  // worst surface of an object
  for (const SurfaceSightings& seen : plan.sightings) {
    if (seen.points >= wanted) {
      ++coverage.enough;
      continue;
    }
    const Scene& scene = *room.scene;
    const std::string& object = scene.objects()[scene.owner(seen.surface).object].name;
    const auto [entry, added] = weak.emplace(printable(object), &seen);
    if (seen.points < entry->second->points) {
      entry->second = &seen;
    }
  }
  for (const auto& [object, seen] : weak) {
    coverage.weak.push_back(
        {object, room.access_points[seen->access_point].id, seen->points, seen->candidates});
  }
  return coverage;
}

}  // namespace

Expected<PlannedSurvey> run_plan(const PlanArguments& arguments, const Observer& observer) {
  auto site = load_site(arguments.site);
  RAYLOC_TRY(site);
  auto room = load_room_model(*site);
  RAYLOC_TRY(room);
  note_scene(*room->scene, observer);
  SurveyPlanOptions options;
  options.points = arguments.points;
  options.is_free = [&](const Vec3d& p) { return !solid_around(*room->scene, p); };
  const SurveyPlan plan = plan_survey(*room, options);
  if (plan.points.empty()) {
    return bad_input(
        fmt::format("{}: no access point receives a device at any free place at {:g} m; check "
                    "[bounds], the height of the device and the access points",
                    arguments.site,
                    room->device.height));
  }
  PlannedSurvey planned;
  planned.points = named(*room, plan.points);
  planned.coverage = coverage_of(plan, *room, options.sightings);
  planned.room = *std::move(room);
  return planned;
}

draw::Drawing draw_plan(const PlannedSurvey& planned) {
  const RoomModel& room = planned.room;
  draw::ScenePicture picture;
  picture.scene = room.scene.get();
  picture.title = room.name;
  picture.caption = fmt::format(
      "survey: {} points at {:g} m, every third {:g} m above or below, in the order to walk",
      planned.points.size(),
      room.device.height,
      kOffHeight);
  for (const RoomAccessPoint& ap : room.access_points) {
    draw::Mark mark{ap.id, draw::MarkKind::kAccessPoint, {}, {}};
    for (std::size_t i = 0; i < ap.array.element_offset.size(); ++i) {
      mark.antennas.push_back(element_position(ap.array, i));
    }
    mark.heading = rotation(ap.array.pose.orientation) * Vec3d{1.0, 0.0, 0.0};
    picture.marks.push_back(std::move(mark));
  }
  for (const PlannedPoint& point : planned.points) {
    picture.marks.push_back({point.name, draw::MarkKind::kTransmitter, {point.position}, {}});
  }
  return draw::draw_scene(picture, draw::View::kPlan);
}

}  // namespace rayloc
