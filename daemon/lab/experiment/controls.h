// Controls of a study: baselines that use nothing, or
// only the survey. They are used in a study like methods.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "daemon/lab/experiment/study_world.h"
#include "engine/base/expected.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct ControlName {
  std::string_view name;
  std::string_view meaning;
};

std::span<const ControlName> control_names();

// An estimate for a test point and the number of the repeat. For a walk, a test point is a burst,
// at the position where the walk begins.
using Locate = std::function<LocationEstimate(const StudyPoint& test_point, std::size_t repeat)>;

// Returns an Error with a message if the layout lacks what the control needs. `constant_power`:
// received power may be learned. REQUIRES: a name of control_names(); `layout` outlives the result.
Expected<Locate> make_control(std::string_view name,
                              std::shared_ptr<const RoomModel> room,
                              const StudyLayout& layout,
                              bool constant_power,
                              std::uint64_t seed);

}  // namespace rayloc
