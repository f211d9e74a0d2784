// How sure a localizer may be: fixes of the points that were held out, against where they are.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "daemon/calibrate/report/calibration_report.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct HeldOutSpot {
  Vec3d position;                    // [m]
  std::span<const CsiFrame> frames;  // not empty
};

// The exponent of the likelihood (RoomModel::likelihood_exponent), and RoomModel::least_sigma with
// it, that have the best log score (to within what the spots can tell) are the last of what is
// returned: that of the probabilities stated for the spots. It punishes regions that are too narrow
// and regions that are too wide alike, so that those of 50 % come out right as well as those of 95
// %. Spots are compared by where they were surveyed, with `survey_sigma` [m] on each axis, which is
// no error of the fix. Those at other heights than the one that is assumed of devices do not count,
// although they tell a calibration about the room. With few spots nothing can be said, and only the
// room's are tried.
Expected<std::vector<HeldOutFixes>> fit_certainty_of(std::shared_ptr<const RoomModel> room,
                                                     std::span<const HeldOutSpot> all,
                                                     double survey_sigma);

}  // namespace rayloc
