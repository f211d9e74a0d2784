// PointArrays: the array that a calibrated room predicts for a transmitter at a known position.
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

// Motion of an array relative to its calibrated pose; it rotates about its centre.
struct ArrayMotion {
  Vec3d shift;       // [m], axes of the room
  double yaw = 0.0;  // [rad], to the left
};

// Thread safety: const members may be used from many threads.
class PointArrays {
 public:
  PointArrays(const RoomModel& room, std::size_t access_point);

  // The paths from the position to the centre of the array; empty if no ray arrives.
  std::vector<Ray> rays(const Vec3d& position, const DeviceModel& device) const;

  // [rx_chain][tone] at the antennas, before the chains. `plan_tolerance` [m]: position error of
  // surfaces; reflections are weighted less for larger values. A moved array meets the same rays.
  std::vector<std::complex<double>> expected(const std::vector<Ray>& rays,
                                             double plan_tolerance,
                                             const ArrayMotion& motion = {}) const;

  // Share of the power of the rays that `expected` contains with their phases, 0 to 1: the phases
  // of the rest are not predictable from a plan with that tolerance.
  double known_share(const std::vector<Ray>& rays, double plan_tolerance) const;

  // [rad], uncertainty of the phase of each chain relative to the first for a position error of
  // `place_sigma` [m] along each axis: computed from the arrays at shifted positions.
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
