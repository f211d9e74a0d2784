// The learned state of receive chains, as a message.
#pragma once

#include "engine/chains/chain_learner.h"
#include "engine/room/room_model.h"
#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {

v1::ChainReport chain_report(const ChainState& state, const RoomModel& room);

}  // namespace rayloc
