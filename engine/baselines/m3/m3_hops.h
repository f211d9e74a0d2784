// M3Received: the CSI that one access point received from a device that hops over radio channels,
// one array per channel.
//
// Each hop has an unknown factor and an unknown delay of its own, as every burst has. Its chain
// gains are those of the site's channel, tone by tone from the centre: a site is calibrated on one
// channel. The assumption is good for the response of a chain at baseband and for amplitudes. A
// cable that is longer than another by a delay T changes the phase between the two chains by 2 pi T
// times the distance between the channels: 0.1 ns, 2 cm of cable, give 0.09 rad from channel 36 to
// 64. Phases between chains are therefore correct only for equal cables. `chain_delay_ns` of
// `rayloc simulate --impairments` simulates that error. Rejected: to leave out channels without
// gains of their own (no recording would have a second hop); to extend the phase slope of a chain
// to other channels (the slope of baseband filters ends there).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/baselines/paths/bearing.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/observe/burst.h"
#include "engine/room/room_model.h"

namespace rayloc {

// The CSI of one radio channel, up to a factor and a delay: [antenna][tone].
struct M3Hop {
  OfdmGrid grid;
  Eigen::MatrixXcd h;
};

// All channels of one access point.
struct M3Received {
  std::size_t access_point = 0;
  AntennaLine line;
  std::vector<M3Hop> hops;  // the lowest channel first
};

// The frames of one radio channel, in their order.
struct ChannelFrames {
  OfdmGrid grid;  // the tones of the site about the centre of the channel
  std::vector<CsiFrame> frames;
};

// Frames by channel, the lowest first. Frames that state no channel are assigned to the site's
// channel, `site`.
std::vector<ChannelFrames> by_channel(const OfdmGrid& site, std::span<const CsiFrame> frames);

struct ObservedHops {
  M3Received received;
  BurstObservation burst;  // of the first hop, with the counts and times of all
};

// Empty if an access point has no two antennas in a line on any channel. All hops have the same
// antennas: channels with another dead antenna are left out. Problems become warnings.
// REQUIRES: calibration_problem() of the access point is empty.
std::optional<ObservedHops> observe_hops(const RoomModel& room,
                                         std::size_t access_point,
                                         std::span<const ChannelFrames> channels,
                                         std::vector<std::string>& warnings);

}  // namespace rayloc
