// Texts on the state of receive chains, for reasons, warnings and the log.
#pragma once

#include <span>
#include <string>

#include "engine/chains/chain_state.h"
#include "engine/monitor/calibration_monitor.h"
#include "engine/room/room_model.h"

namespace rayloc {

// "learning the chains of ap1: 12 bursts, evidence 3.1 of 7.0 for one state of the chains"
std::string learning_text(const ChainState& state, const RoomModel& room);
// The same for all access points whose chains are being learned; empty: none.
std::string learning_texts(std::span<const ChainState> states, const RoomModel& room);
// "core 0 by 173 degrees +- 5, core 3 by 113 degrees +- 6 against core 1"
std::string rotations_text(const ChainState& state, const RoomModel& room);
// Warning that the CSI of an access point is not used. REQUIRES: its chains are being learned.
CalibrationWarning learning_warning(const ChainState& state, const RoomModel& room);
// The array of a fixed transmitter contains the learned factors (ReferenceChains).
std::string other_reference_text(const RoomAccessPoint& access_point);

}  // namespace rayloc
