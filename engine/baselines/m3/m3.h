// M3: devices by the bearing of the direct path, and bearings and delays of reflections behind it,
// at one access point [M3]. Which walls there are is known; radio channels that a device hops over
// are one wide band.
//
// The published objective is not readable to us. Ours is the likelihood
//
//   ll(p) = ln N(u_0 - u_0(p); s_u) + sum over later paths i of
//           ln[q / J sum over mirrors j of N(u_i - u_j(p); s) N(tau_i - tau_0 - D_j(p); s_tau)
//              + (1 - q) uniform]
//
// with sines u on the circle of aliases, u_j and D_j of the place mirrored in j, and s_tau the
// larger of 1 ns and a tenth of the band's resolution. A mirror is a plane without an end or a
// material, and nothing is mirrored twice: the method traces no rays.
//
// locate() makes a hop of each channel that the frames state (m3_hops.h).
//
// References: [M3] M3, IEEE Transactions on Mobile Computing, 2021.
// Thread safety: const members may be used from many threads.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/baselines/m3/m3_hops.h"
#include "engine/baselines/m3/m3_options.h"
#include "engine/baselines/paths/bearing.h"
#include "engine/baselines/paths/sage.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"
#include "engine/scene/surface.h"

namespace rayloc {

// The paths of that, the first in time at the front, and their band [Hz].
struct M3Paths {
  std::size_t access_point = 0;
  AntennaLine line;
  double wavelength = 0.0;  // [m], of the first hop
  double band = 0.0;
  std::vector<SagePath> paths;
};

class M3 {
 public:
  // An Error where the room cannot be modelled at all, or no plane bounds it.
  static Expected<M3> create(std::shared_ptr<const RoomModel> room, const M3Options& options);

  // `frames`: one transmitter, any access points, in order of time; of channels as wide as the
  // site's.
  LocationEstimate locate(std::span<const CsiFrame> frames) const;

  // The steps of it: for hops, studies and tests. REQUIRES: a hop, and at least one access point.
  M3Paths find_paths(const M3Heard& heard) const;
  void summarise(std::span<const M3Paths> heard, LocationEstimate& estimate) const;

  const RoomModel& room() const { return *room_; }

 private:
  M3(std::shared_ptr<const RoomModel> room, const M3Options& options);
  double log_likelihood(const M3Paths& heard, const Vec3d& place) const;

  std::shared_ptr<const RoomModel> room_;
  M3Options options_;
  std::vector<std::size_t> usable_;                     // access points
  std::vector<std::vector<Plane<double>>> reflectors_;  // of each access point of the room
  std::vector<std::string> warnings_;
};

}  // namespace rayloc
