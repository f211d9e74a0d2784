// PositionLoss: the loss of the paper's device-based localization at a position, and its
// gradient from the tracer's derivatives (METHODS A4; formula: Localizer).
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/paper/csi_loss.h"
#include "engine/paper/descent.h"
#include "engine/room/room_model.h"
#include "engine/trace/array_tracer.h"

namespace rayloc::paper {

// A usable access point of the room.
struct UsableAccessPoint {
  std::size_t access_point = 0;  // index in RoomModel::access_points
  ArrayTracer tracer;
};

// Burst received by an access point.
struct Measurement {
  const UsableAccessPoint* ap;
  std::vector<std::complex<double>> h;  // [antenna][tone], chain gains removed
  CsiLoss::Observables observables;
};

// Thread safety: const members may be used from many threads.
class PositionLoss {
 public:
  // The arguments must outlive it. REQUIRES: at least one measurement.
  PositionLoss(const RoomModel& room,
               const CsiLoss& csi_loss,
               std::span<const Measurement> measured,
               double centre_weight);

  LossInPlan at(const Vec3d& position) const;

  // Unexplained share of the power for a device at a position, mean over the measurements [dB]: 0
  // if no path leads to any of the access points.
  double model_residual_db(const Vec3d& position) const;
  // True if a path leads to one of the access points.
  bool is_reached(const Vec3d& position) const;

 private:
  LossInPlan of_access_point(const Measurement& measured, const Vec3d& position) const;
  std::vector<Paths> trace(const UsableAccessPoint& ap, const Vec3d& position) const;

  const RoomModel& room_;
  const CsiLoss& csi_loss_;
  std::span<const Measurement> measured_;
  double centre_weight_;
};

}  // namespace rayloc::paper
