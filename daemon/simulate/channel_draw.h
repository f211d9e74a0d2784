// ChannelDraw: the channel of a device, as far from the traced one as the calibration found those
// of the site to be. With a_p, tau_p the rays that the likelihood knows (METHODS B2, `partial`), P
// the sum of |a_p|^2,
//
//   h[m,k] = sum_p a_p (e^{j x_p} + e_p) e^{-j 2 pi f_k tau_mp}
//            + (P d)^1/2 T[m,k] + (P n)^1/2 N[m,k],
//
// x_p, of deviation sigma_p, what displaced surfaces do to a phase, e_p what a ray's strength is
// uncertain by, T a tail that sets in with the first ray and decays exponentially, other in every
// antenna, and N white. It is new at every place, as the likelihood takes it to be: who locates
// such channels with the same site makes the errors that are left when nothing but this is unknown.
#pragma once

#include <complex>
#include <cstddef>
#include <random>
#include <vector>

#include "daemon/simulate/random_stream.h"
#include "engine/base/vec3.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/likelihood/observation_model.h"
#include "engine/room/room_model.h"
#include "engine/scene/antenna_array.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {

class ChannelDraw {
 public:
  // REQUIRES: access_point < room.access_points.size().
  ChannelDraw(const RoomModel& room, std::size_t access_point, RandomStream random);

  struct Channel {
    std::vector<std::complex<double>> h;  // [antenna][tone], of the field at the antennas
    std::size_t rays = 0;                 // 0: h is 0
  };
  // Of the room's device there.
  Channel at(const Pose& pose, const OfdmGrid& grid);

 private:
  std::complex<double> normal();  // complex, of unit power
  // To the tones of one antenna; it sets in at `first` [s].
  void add_tail(double power, double first, const OfdmGrid& grid, std::complex<double>* row);

  RoomModel room_;
  ModelError error_;            // how far channels differ
  std::vector<Vec3d> offsets_;  // [m], of the antennas from the array's centre
  ReceiverTracer tracer_;
  ObservationModel model_;
  RandomStream random_;
  std::normal_distribution<double> normal_;
};

}  // namespace rayloc
