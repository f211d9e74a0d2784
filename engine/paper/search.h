// The descent of method `paper` from random places of a room, shared by the localizers of devices
// and of people (METHODS A4).
//
// Random numbers are seeded for every fix from the seed, the time of the first frame and the number
// of the start: the same frames give the same bytes, in any order of fixes and on any number of
// threads.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/paper/descent.h"
#include "engine/paper/options.h"
#include "engine/room/room_model.h"

namespace rayloc::paper {

// A ratio, chosen: limits a perfect match to -300 dB.
inline constexpr double kMinResidual = 1e-30;

// The room in plan, reduced by `margin` [m]; by less if the room is too narrow.
PlanBounds plan_bounds(const RoomModel& room, double margin);

// Parameters of a search: its random numbers and the height that it keeps.
struct Search {
  PlanBounds bounds;
  double height = 0.0;  // [m]
  std::uint64_t seed = 1;
  Timestamp time;
};

struct End {
  Vec3d position;
  double loss = 0.0;
};

// The end point with the least loss among LocalizerOptions::starts descents. `loss` is called
// from several threads. REQUIRES: valid options.
End search(const std::function<LossInPlan(const Vec3d&)>& loss,
           const Search& from,
           const LocalizerOptions& options);

// gamma_2 |xy - c|^2 with c the middle of the room (METHODS C4).
LossInPlan centre_loss(const RoomModel& room, double weight, const Vec3d& position);

}  // namespace rayloc::paper
