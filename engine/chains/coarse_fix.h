// locate_coarsely: where a device is by access points whose chains nobody knows.
//
// How the antennas' phases differ says nothing then; the delays and powers of the paths at each
// antenna still do. What is stated is the mean over all states of the chains, each as probable as
// any other, so it depends on these frames alone and not on what has been learned so far.
#pragma once

#include <span>

#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"

namespace rayloc {

// `frames`: of one transmitter, in order of time, as ChainLearner::undone() leaves them. Decimetres
// to metres: its region says which. Without a position `reason` says why.
// REQUIRES: ChainLearner::learns_from() the localizer's likelihood.
LocationEstimate locate_coarsely(const Localizer& localizer, std::span<const CsiFrame> frames);

}  // namespace rayloc
