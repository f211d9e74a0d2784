// A person in the synthetic room, who carries no device: frames of a fixed transmitter as the
// access points receive it past the body, and the reference of the empty room.
#pragma once

#include <complex>
#include <vector>

#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"
#include "engine/trace/scattering/target_body.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::test {

Transmitter fixed_transmitter();

// Channels of every access point past bodies at these positions (waves that meet two bodies are
// left out, as are those that meet one twice), traced one reflection deeper than in a localizer,
// separately for each antenna. Empty: the empty room.
std::vector<std::vector<std::complex<double>>> channels_past(
    const RoomModel& room, const std::vector<TargetPosition>& places, const TargetBody& body = {});

std::vector<CsiFrame> frames_past(const RoomModel& room,
                                  const std::vector<TargetPosition>& places,
                                  const TargetBody& body = {},
                                  const FrameOptions& options = {});

// The direct path only from the fixed transmitter, as channel_at() of the synthetic room.
std::vector<std::complex<double>> direct_channel(const RoomModel& room, const RoomAccessPoint& ap);

// The reference of all access points, learned from frames of the empty room.
PersonReference learn_reference(const RoomModel& room);

}  // namespace rayloc::test
