// ChannelDraw: draws a device's channel with the deviation from the
// traced one that the calibration found at the site. With a_p, tau_p the
// rays in the likelihood (METHODS B2, `partial`), P the sum of |a_p|^2,
//
//   h[m,k] = sum_p a_p (e^{j x_p} + e_p) e^{-j 2 pi f_k tau_mp}
//            + (P d)^1/2 T[m,k] + (P n)^1/2 N[m,k],
//
// x_p, of deviation sigma_p, is the phase error from displaced surfaces, e_p the error of a ray's
// strength, T a tail that begins with the first ray and decays exponentially, independent at each
// antenna, and N is white. The draw is new at every place, as the likelihood assumes: locating such
// channels with the same site gives the errors that remain when only this is unknown.
#pragma once

#include <complex>
#include <cstddef>
#include <random>
#include <vector>

#include "daemon/lab/simulate/random_stream.h"
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
    std::vector<std::complex<double>> h;  // [antenna][tone], field at the antennas
    std::size_t rays = 0;                 // 0: h is 0
  };
  // Channel of the room's device at that pose.
  Channel at(const Pose& pose, const OfdmGrid& grid);

 private:
  std::complex<double> normal();  // complex, of unit power
  // Adds to the tones of one antenna; it begins at `first` [s].
  void add_tail(double power, double first, const OfdmGrid& grid, std::complex<double>* row);

  RoomModel room_;
  ModelError error_;            // deviations of the channels
  std::vector<Vec3d> offsets_;  // [m], antenna positions from the array's centre
  ReceiverTracer tracer_;
  ObservationModel model_;
  RandomStream random_;
  std::normal_distribution<double> normal_;
};

}  // namespace rayloc
