// PaperPositionLoss: the loss of the paper's device-based localization at a position, and its
// gradient by the tracer's derivatives (METHODS A4; PaperLocalizer has the formula).
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/paper/paper_csi_loss.h"
#include "engine/paper/paper_descent.h"
#include "engine/room/room_model.h"
#include "engine/trace/array_tracer.h"

namespace rayloc {

// An access point of the room that can be used.
struct PaperAccessPoint {
  std::size_t access_point = 0;  // of RoomModel::access_points
  ArrayTracer tracer;
};

// What it heard.
struct PaperMeasurement {
  const PaperAccessPoint* ap;
  std::vector<std::complex<double>> h;  // [antenna][tone], chain gains removed
  PaperCsiLoss::Observables observables;
};

// Thread safety: const members may be used from many threads.
class PaperPositionLoss {
 public:
  // What is passed outlives it. REQUIRES: a measurement.
  PaperPositionLoss(const RoomModel& room,
                    const PaperCsiLoss& csi_loss,
                    std::span<const PaperMeasurement> measured,
                    double centre_weight);

  LossInPlan at(const Vec3d& position) const;

  // Share of the power that the model at a position leaves unexplained, mean over the measurements
  // [dB]: 0 where no path leads to any of them.
  double model_residual_db(const Vec3d& position) const;
  // A path leads to one of the access points.
  bool is_reached(const Vec3d& position) const;

 private:
  LossInPlan of_access_point(const PaperMeasurement& measured, const Vec3d& position) const;
  std::vector<Paths> trace(const PaperAccessPoint& ap, const Vec3d& position) const;

  const RoomModel& room_;
  const PaperCsiLoss& csi_loss_;
  std::span<const PaperMeasurement> measured_;
  double centre_weight_;
};

}  // namespace rayloc
