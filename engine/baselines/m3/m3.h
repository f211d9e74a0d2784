// M3: locates devices by the bearing of the direct path, and bearings and delays of reflections
// after it, at one access point [M3]. The walls are given; radio channels that a device hops over
// form one wide band.
//
// The published objective was not available to us. Ours is the likelihood
//
//   ll(p) = ln N(u_0 - u_0(p); s_u) + sum over later paths i of
//           ln[q / J sum over mirrors j of N(u_i - u_j(p); s) N(tau_i - tau_0 - D_j(p); s_tau)
//              + (1 - q) uniform]
//
// with sines u on the circle of aliases, u_j and D_j for the place mirrored in j, and s_tau the
// larger of 1 ns and a tenth of the band's resolution. A mirror is an infinite plane without a
// material, and nothing is mirrored twice: the method traces no rays.
//
// locate() makes one hop of each channel that the frames state (m3_hops.h).
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

// The paths of an M3Received, the earliest first, and their band [Hz].
struct M3Paths {
  std::size_t access_point = 0;
  AntennaLine line;
  double wavelength = 0.0;  // [m], of the first hop
  double band = 0.0;
  std::vector<SagePath> paths;
};

class M3 {
 public:
  // An Error if the room cannot be modelled, or if no plane bounds it.
  static Expected<M3> create(std::shared_ptr<const RoomModel> room, const M3Options& options);

  // `frames`: one transmitter, any access points, in order of time; channels with the bandwidth of
  // the site's.
  LocationEstimate locate(std::span<const CsiFrame> frames) const;

  // The steps of locate(), for hops, studies and tests. REQUIRES: a hop and an access point.
  M3Paths find_paths(const M3Received& received) const;
  void summarise(std::span<const M3Paths> received, LocationEstimate& estimate) const;

  const RoomModel& room() const { return *room_; }

 private:
  M3(std::shared_ptr<const RoomModel> room, const M3Options& options);
  double log_likelihood(const M3Paths& received, const Vec3d& place) const;

  std::shared_ptr<const RoomModel> room_;
  M3Options options_;
  std::vector<std::size_t> usable_;                     // indices of access points
  std::vector<std::vector<Plane<double>>> reflectors_;  // of each access point of the room
  std::vector<std::string> warnings_;
};

}  // namespace rayloc
