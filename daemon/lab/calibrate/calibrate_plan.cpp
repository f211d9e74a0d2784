#include "daemon/lab/calibrate/calibrate_plan.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/base/output_file.h"
#include "daemon/lab/draw/picture_bytes.h"
#include "daemon/lab/draw/scene_picture.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_notes.h"
#include "daemon/site/scene/solid_around.h"
#include "daemon/site/survey/planned_points.h"
#include "engine/base/printable.h"
#include "engine/calibrate/survey_plan.h"

namespace rayloc::cli {
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

draw::Drawing picture_of(const RoomModel& room, const std::vector<PlannedPoint>& points) {
  draw::ScenePicture picture;
  picture.scene = room.scene.get();
  picture.title = room.name;
  picture.caption = fmt::format(
      "survey: {} points at {:g} m, every third {:g} m above or below, in the order to walk",
      points.size(),
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
  for (const PlannedPoint& point : points) {
    picture.marks.push_back({point.name, draw::MarkKind::kTransmitter, {point.position}, {}});
  }
  return draw::draw_scene(picture, draw::View::kPlan);
}

Expected<void> write_picture(const draw::Drawing& drawing, const std::string& file) {
  const auto bytes = draw::picture_bytes(drawing, file);
  return bytes ? write_file(file, *bytes) : tl::make_unexpected(bytes.error());
}

std::string picture_file(const PlanArguments& arguments) {
  if (!arguments.picture.empty() || arguments.out == "-") {
    return arguments.picture;
  }
  return std::filesystem::path(arguments.out).replace_extension(".svg").string();
}

// Objects with a surface whose reflections some access point receives at too few points.
void print_coverage(const SurveyPlan& plan, const RoomModel& room, std::size_t wanted) {
  std::size_t enough = 0;
  std::map<std::string, const SurfaceSightings*> weak;  // worst surface of an object
  for (const SurfaceSightings& seen : plan.sightings) {
    if (seen.points >= wanted) {
      ++enough;
      continue;
    }
    const Scene& scene = *room.scene;
    const std::string& object = scene.objects()[scene.owner(seen.surface).object].name;
    const auto [entry, added] = weak.emplace(printable(object), &seen);
    if (seen.points < entry->second->points) {
      entry->second = &seen;
    }
  }
  std::fprintf(stderr,
               "%zu points of %zu places; %zu of %zu pairs of surface and access point are seen in "
               "reflections from %zu points or more\n",
               plan.points.size(),
               plan.candidates,
               enough,
               plan.sightings.size(),
               wanted);
  for (const auto& [object, seen] : weak) {
    std::fprintf(stderr,
                 "  %s: a side of it to %s from %zu of the %zu places where it is seen\n",
                 object.c_str(),
                 room.access_points[seen->access_point].id.c_str(),
                 seen->points,
                 seen->candidates);
  }
}

// Measured median errors at 50 points, by the number of survey points to 3 cm
// (engine/studies/2026-11-accuracy.md): a meeting room of 3.5 x 2.9 m and a corridor of 31 x 2.7 m.
struct MeasuredSurvey {
  std::size_t points;
  const char* worth;
};
constexpr std::array<MeasuredSurvey, 3> kMeasured = {
    {{12, "2 cm and 9 cm with three access points, 0.5 m and 1.8 m with one"},
     {36, "2 cm and 4 cm with three access points, 0.4 m and 0.4 m with one"},
     {143, "18 cm with one access point in the meeting room"}}};

// Prints the largest measured survey not larger than the plan, and the gain of more points.
void print_worth(std::size_t points) {
  const MeasuredSurvey* found = nullptr;
  for (const MeasuredSurvey& one : kMeasured) {
    found = one.points <= points ? &one : found;
  }
  if (found == nullptr) {
    return;
  }
  std::fprintf(stderr,
               "expected accuracy, as measured in a meeting room of 3.5 x 2.9 m and a corridor of "
               "31 x 2.7 m: %zu points surveyed to 3 cm located devices to %s\n",
               found->points,
               found->worth);
  if (const MeasuredSurvey* const more = found + 1; more != kMeasured.data() + kMeasured.size()) {
    std::fprintf(
        stderr, "  %zu points (--plan-points %zu): %s\n", more->points, more->points, more->worth);
  }
}

}  // namespace

Expected<void> run_plan(const PlanArguments& arguments) {
  auto site = load_site(arguments.site);
  if (!site) {
    return tl::make_unexpected(std::move(site.error()));
  }
  const auto room = load_room_model(*site);
  if (!room) {
    return tl::make_unexpected(room.error());
  }
  if (!arguments.quiet) {
    print_scene_notes(*room->scene);
  }
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
  const std::vector<PlannedPoint> points = named(*room, plan.points);
  if (const std::string file = picture_file(arguments); !file.empty()) {
    if (auto drawn = write_picture(picture_of(*room, points), file); !drawn) {
      return drawn;
    }
  }
  auto out = OutputFile::open(arguments.out);
  if (!out) {
    return tl::make_unexpected(std::move(out.error()));
  }
  out->write(to_csv(points));
  if (!arguments.quiet) {
    print_coverage(plan, *room, options.sightings);
    print_worth(plan.points.size());
  }
  return out->close();
}

}  // namespace rayloc::cli
