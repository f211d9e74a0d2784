// The plan of a survey as a use case: the points to survey, and how well they cover the surfaces.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/site/plan/drawing.h"
#include "daemon/site/survey/planned_points.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlanArguments {
  std::string site;
  std::size_t points = 12;  // half an hour on foot; 36 and 143 constrain one access point better
};

// An object whose reflections an access point receives at too few points: its worst surface.
struct WeakObject {
  std::string object;  // printable name
  std::string access_point;
  std::size_t points = 0;      // of the plan
  std::size_t candidates = 0;  // places where the surface is seen
};

struct PlanCoverage {
  std::size_t candidates = 0;    // places that were compared
  std::size_t pairs = 0;         // of surface and access point
  std::size_t enough = 0;        // pairs seen from `wanted` points or more
  std::size_t wanted = 0;        // points
  std::vector<WeakObject> weak;  // by name
};

struct PlannedSurvey {
  std::vector<PlannedPoint> points;  // in walking order
  PlanCoverage coverage;
  RoomModel room;
};

// Returns an Error if the site cannot be read or no position is available. `observer` receives the
// notes on the scene. Thread-safe.
Expected<PlannedSurvey> run_plan(const PlanArguments& arguments, const Observer& observer = {});

// The points in the plan of the room.
draw::Drawing draw_plan(const PlannedSurvey& planned);

}  // namespace rayloc
