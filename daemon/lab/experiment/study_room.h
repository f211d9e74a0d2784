// The rooms of a study: a plan with clutter, as it is and as the model has it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/lab/experiment/condition.h"
#include "daemon/site/scene/room_plan.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

// The plan of a condition with access points at their height and the clutter of a layout: boxes of
// wood and metal, 0.3 to 0.8 m wide and 0.5 to 1.5 m high, standing on the floor at any position
// and yaw, clear of each other, of the plan's objects and of the access points. Errors name the
// plan: too few access points, no room for so many boxes.
Expected<RoomPlan> furnish(const RoomPlan& plan,
                           const Condition& condition,
                           std::uint64_t seed,
                           std::size_t layout);

// The plan with ceiling, walls and boxes displaced by Condition::plan_error_m.
RoomPlan misplace(RoomPlan plan,
                  const Condition& condition,
                  std::uint64_t seed,
                  std::size_t layout);

// The plan on each radio channel that devices of the condition hop over, or the plan alone. Errors
// name the plan: text that is no list of its channels, fewer frames than channels.
Expected<std::vector<RoomPlan>> on_channels(const RoomPlan& plan, const Condition& condition);

// The uncalibrated room: no chain gains. REQUIRES: a plan that was read without error.
Expected<RoomModel> make_room(const RoomPlan& plan, const Condition& condition);

// True if a place is inside a box of the plan, or closer than `margin` to it.
bool is_in_box(const RoomPlan& plan, const Vec3d& place, double margin);

}  // namespace rayloc
