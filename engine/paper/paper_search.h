// The way down of method `paper` from random places of a room: what a device and a person without
// one have in common (METHODS A4).
//
// Random numbers are drawn anew for every fix, from the seed, the time of the first frame and the
// number of the start: the same frames give the same bytes, in any order of fixes and on any number
// of threads.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/paper/paper_descent.h"
#include "engine/paper/paper_options.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A ratio, chosen: a perfect match is -300 dB and not infinite.
inline constexpr double kMinResidual = 1e-30;

// The room in plan, `margin` [m] inside; as far as that goes in a narrower one.
PlanBounds plan_bounds(const RoomModel& room, double margin);

// Where a search is for: its draws and the height that it keeps.
struct PaperSearch {
  PlanBounds bounds;
  double height = 0.0;  // [m]
  std::uint64_t seed = 1;
  Timestamp time;
};

struct PaperEnd {
  Vec3d position;
  double loss = 0.0;
};

// The end of least loss among those of PaperLocalizerOptions::starts descents. `loss` is called
// from several threads. REQUIRES: valid options.
PaperEnd search(const std::function<LossInPlan(const Vec3d&)>& loss,
                const PaperSearch& from,
                const PaperLocalizerOptions& options);

// gamma_2 |xy - c|^2 with c the middle of the room (METHODS C4).
LossInPlan centre_loss(const RoomModel& room, double weight, const Vec3d& position);

}  // namespace rayloc
