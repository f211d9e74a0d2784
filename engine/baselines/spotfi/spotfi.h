// Spotfi: locates devices by the bearings of their direct paths and by received power [SF].
//
// The published method sums squares of angles over access points. Here each bearing is a likelihood
// on the circle of phases, with a share of outliers, so that a region can be stated and aliases of
// wide arrays are preserved:
//
//   ll(p) = sum over APs of ln[(1 - e) N(wrap(psi - psi(p)); s) + e / (2 pi)] + power
//
// with s^2 = s_0^2 max L / L_i, at most 9 s_0^2 (L: how likely the path is direct). The power is
// -(power - law(r))^2 / (2 sigma^2) for transmitters of constant power with a learned law; for
// others their unknown power is eliminated, and differences between access points remain. Power and
// map are ours. RayLoc's traced power is not used: the method has no walls.
//
// References: [SF] M. Kotaru et al., SpotFi, SIGCOMM 2015.
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/baselines/paths/tone_comb.h"
#include "engine/baselines/spotfi/spotfi_options.h"
#include "engine/baselines/training.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

class Spotfi {
 public:
  // `training`: null without a training. An Error if the room cannot be modelled. An access point
  // without chain gains is left out, with a warning in every estimate.
  static Expected<Spotfi> create(std::shared_ptr<const RoomModel> room,
                                 const SpotfiOptions& options,
                                 std::shared_ptr<const Training> training);

  // `frames`: one transmitter, any access points, in order of time. `repeat`: varies the seed.
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat = 0) const;

  const RoomModel& room() const { return *room_; }

 private:
  struct Received;

  Spotfi(std::shared_ptr<const RoomModel> room,
         const SpotfiOptions& options,
         std::shared_ptr<const Training> training);
  std::string refusal(std::span<const Received> received) const;
  double log_likelihood(std::span<const Received> received, const Vec3d& place) const;
  double power_log_likelihood(std::span<const Received> received, const Vec3d& place) const;

  std::shared_ptr<const RoomModel> room_;
  SpotfiOptions options_;
  std::shared_ptr<const Training> training_;
  ToneComb comb_;
  std::vector<std::size_t> usable_;  // indices of access points
  std::vector<std::string> warnings_;
};

// Learns sigma, outliers and, for transmitters of constant power, the path-loss law of each access
// point.
Expected<std::shared_ptr<const Training>> train_spotfi(const TrainingInput& input);

}  // namespace rayloc
