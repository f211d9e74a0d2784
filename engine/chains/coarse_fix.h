// locate_coarsely: position of a device from access points with unknown chains.
//
// Phase differences between the antennas then contain no information; the delays and powers of the
// paths at each antenna still do. The probability of a place is a mean over all states of the
// chains, by access point: half of it with equal probabilities, half of it with the belief in the
// states.
#pragma once

#include <span>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"

namespace rayloc {

// `frames`: of one transmitter, in order of time, as returned by ChainLearner::undone(). Accuracy:
// decimetres to metres, as stated by the region, which may cover most of the room: an estimate may
// then have no hypotheses, as none of them has a noticeable share of the probability. Without a
// position `reason` states the cause.
// `beliefs`: [access point of the room][state], probabilities without the evidence of these frames
// (ChainLearner::beliefs_before()); states are equally probable where it is absent or empty.
// REQUIRES: ChainLearner::learns_from() the localizer's likelihood.
LocationEstimate locate_coarsely(const Localizer& localizer,
                                 std::span<const CsiFrame> frames,
                                 std::span<const std::vector<double>> beliefs = {});

}  // namespace rayloc
