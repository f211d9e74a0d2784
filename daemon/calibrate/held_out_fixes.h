// How sure a localizer may be: fixes of the points that were held out, against where they are.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "daemon/calibrate/calibration_report.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/room_model.h"

namespace rayloc {

struct HeldOutSpot {
  Vec3d position;                    // [m]
  std::span<const CsiFrame> frames;  // not empty
};

// The largest exponent of the likelihood (RoomModel::temper) whose 95 % regions hold 95 % of the
// spots is the last of what is returned; those tried before it are larger. With few spots nothing
// can be said, and only room.temper is tried.
Expected<std::vector<HeldOutFixes>> fit_temper(std::shared_ptr<const RoomModel> room,
                                               std::span<const HeldOutSpot> spots);

}  // namespace rayloc
