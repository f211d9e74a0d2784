// plan_survey: places for a device in a survey that make the surfaces of the room observable.
//
// A calibration learns a surface from the reflections on it, so every surface with reflections to
// an access point should be met from several points, and at different angles: steep ones determine
// where the surface is (a path changes by 2 cos(incidence) times its offset), flat ones its
// material. Points are taken one by one from a grid, each time the one that adds most; points that
// no surface needs are placed in empty parts of the room.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct SurveyPlanOptions {
  std::size_t points = 60;
  std::size_t sightings = 8;      // of a surface by an access point: from so many points
  double spacing = 0.25;          // [m], of the grid; wider in rooms of more than kMaxCandidates
  double clearance = 0.2;         // [m], from all objects in the room
  double antenna_distance = 0.5;  // [m], from access points: the arrays must be in the far field
  int max_depth = 2;              // reflections of a path
  double range_db = 30.0;         // paths this much below the strongest of a point do not count
  // True if a device can be placed there; the inside of an object, for example, is not free.
  std::function<bool(const Vec3d&)> is_free = [](const Vec3d&) { return true; };
};

// A count of places, chosen: bounds the time of a plan.
inline constexpr std::size_t kMaxCandidates = 2000;
inline constexpr std::size_t kIncidenceBands = 3;  // 0 to 30, 30 to 60, 60 to 90 degrees

// Sightings of a surface from the points, in reflections to one access point.
struct SurfaceSightings {
  std::uint32_t surface = 0;  // index into Scene::surfaces()
  std::size_t access_point = 0;
  std::size_t points = 0;      // of the plan
  std::size_t candidates = 0;  // of the grid: where more are possible
  std::array<std::size_t, kIncidenceBands> points_in_band{};
};

struct SurveyPlan {
  // In walking order from the corner of the room's lowest coordinates: a short tour, not
  // necessarily the shortest.
  std::vector<Vec3d> points;
  std::vector<SurfaceSightings> sightings;  // of every pair visible from any candidate, by surface
  std::size_t candidates = 0;
};

// At the height of room.device. Returns fewer points than requested when the grid has fewer; none
// when no place is free or no signal is received.
SurveyPlan plan_survey(const RoomModel& room, const SurveyPlanOptions& options);

}  // namespace rayloc
