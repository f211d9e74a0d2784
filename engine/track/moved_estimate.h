// moved_estimate: the estimate of a target for frames that were not compared with any place: the
// last one, moved by its velocity.
#pragma once

#include <span>

#include "engine/channel/csi_frame.h"
#include "engine/track/filtered_estimate.h"

namespace rayloc {

// The position and the hypotheses are moved from the time of `last` to the middle of the frames,
// which are not empty. The regions grow by the uncertainty of the velocity, `speed_variance`
// [m^2/s^2] of each horizontal component. No frame counts as used.
FilteredEstimate moved_estimate(const FilteredEstimate& last,
                                std::span<const CsiFrame> frames,
                                double speed_variance);

}  // namespace rayloc
