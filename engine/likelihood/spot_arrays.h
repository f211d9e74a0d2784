// SpotArrays: the array that a calibrated room expects of a transmitter at a known place.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/likelihood/observation_model.h"
#include "engine/observe/alignment.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {

// How an array stands against its calibrated pose; it turns about its centre.
struct ArrayMotion {
  Vec3d shift;       // [m], axes of the room
  double yaw = 0.0;  // [rad], to the left
};

// Thread safety: const members may be used from many threads.
class SpotArrays {
 public:
  SpotArrays(const RoomModel& room, std::size_t access_point);

  // The paths from there to the centre of the array; empty where no ray arrives.
  std::vector<Ray> rays(const Vec3d& position, const DeviceModel& device) const;

  // [core][tone] at the antennas, before the chains. `plan_tolerance` [m]: how far surfaces may be
  // off; reflections count the less the larger it is. A moved array meets the same rays.
  std::vector<std::complex<double>> expected(const std::vector<Ray>& rays,
                                             double plan_tolerance,
                                             const ArrayMotion& motion = {}) const;

  // Share of the power of the rays that `expected` holds with their phases, 0 to 1: the rest
  // arrives too, but how is beyond a plan with that tolerance.
  double known_share(const std::vector<Ray>& rays, double plan_tolerance) const;

  // [rad], by how much the phase of each chain against the first is uncertain when the place is, by
  // `place_sigma` [m] along each axis: what the array does at places shifted by that much.
  std::vector<double> place_phase_sigma(const Vec3d& position,
                                        const DeviceModel& device,
                                        double plan_tolerance,
                                        double place_sigma) const;

 private:
  RoomModel room_;
  Aligner aligner_;
  RoomAccessPoint access_point_;
  ObservationModel model_;
  ReceiverTracer tracer_;
};

}  // namespace rayloc
