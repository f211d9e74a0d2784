// The direct path of a burst at one access point, as in SpotFi [SF]: MUSIC on each frame, clusters
// of the paths of all frames, and selection of the tightest, heaviest and earliest cluster.
//
// References: [SF] M. Kotaru et al., SpotFi, SIGCOMM 2015.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/baselines/paths/bearing.h"
#include "engine/baselines/paths/path_count.h"
#include "engine/baselines/paths/tone_comb.h"
#include "engine/channel/csi_frame.h"
#include "engine/observe/burst.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Weights in ln L = share of the cluster w_share - deviation of its phase w_psi - of its delay
// w_tau - its mean delay w_soon, with phases in half turns and delays in kDelayUnit.
struct DirectPathOptions {
  std::size_t frames = 10;  // of a burst, at most
  std::size_t clusters = 5;
  PathCountRule count = PathCountRule::kDrop;
  double w_share = 1.0;
  double w_psi = 10.0;
  double w_tau = 10.0;
  double w_soon = 1.0;
};

struct DirectPath {
  double psi = 0.0;         // [rad], from one antenna of `line` to the next
  double likelihood = 0.0;  // L
  AntennaLine line;
  BurstObservation burst;  // all frames together, chain gains removed
};

// Parameters of the search; `comb`, of the room's tones, must outlive it.
struct DirectPathSearch {
  const ToneComb& comb;
  DirectPathOptions options;
  std::uint64_t seed = 1;
};

// Empty if the access point received no usable frames, with a warning that states the reason.
// REQUIRES: calibration_problem() of the access point is empty, a comb that is not.
std::optional<DirectPath> find_direct_path(const RoomModel& room,
                                           std::size_t access_point,
                                           std::span<const CsiFrame> frames,
                                           const DirectPathSearch& search,
                                           std::vector<std::string>& warnings);

}  // namespace rayloc
