// Calibrates the stated certainty of fixes with fixes of the held-out points.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "daemon/lab/calibrate/report/calibration_report.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct HeldOutPoint {
  Vec3d position;                    // [m]
  std::span<const CsiFrame> frames;  // not empty
};

// Selects the exponent of the likelihood (RoomModel::likelihood_exponent), with
// RoomModel::sigma_floor, of the best log score to within the resolution of the points; the
// selected one is the last of the returned fixes. The log score is that of the probabilities stated
// for the points. It penalizes regions that are too narrow and too wide alike, so that regions of
// 50 % are right as well as those of 95 %. Points are compared by their surveyed positions, with
// `survey_sigma` [m] on each axis, which is no error of the fix. Points at heights other than the
// assumed device height do not count, although they inform a calibration of the room. With few
// points no selection is possible, and only the room's values are tried.
Expected<std::vector<HeldOutFixes>> fit_certainty_of(std::shared_ptr<const RoomModel> room,
                                                     std::span<const HeldOutPoint> all,
                                                     double survey_sigma);

}  // namespace rayloc
