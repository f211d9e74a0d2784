// locate_coarsely: position of a device from access points with unknown chains.
//
// Phase differences between the antennas then contain no information; the delays and powers of the
// paths at each antenna still do. The result is the mean over all states of the chains, with equal
// probabilities, so it depends on these frames alone and not on what has been learned so far.
#pragma once

#include <span>

#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"

namespace rayloc {

// `frames`: of one transmitter, in order of time, as returned by ChainLearner::undone(). Accuracy:
// decimetres to metres, as stated by the region. Without a position `reason` states the cause.
// REQUIRES: ChainLearner::learns_from() the localizer's likelihood.
LocationEstimate locate_coarsely(const Localizer& localizer, std::span<const CsiFrame> frames);

}  // namespace rayloc
