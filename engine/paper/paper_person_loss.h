// PaperPersonLoss: the loss of the paper's device-free localization at a place of a person, and its
// gradient by the tracer's derivatives (METHODS A4; PaperPersonLocalizer has the formula).
//
// The channel with a person is that of the empty room as it was measured and what a body at the
// place adds to it: H0 + a dH(P) of PersonReference. Where the body would hold the transmitter or
// an antenna nothing is known of it: the channel there is H0.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/paper/paper_csi_loss.h"
#include "engine/paper/paper_descent.h"
#include "engine/person/person_scattering.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A link of the reference that can be used.
struct PaperPersonLink {
  std::size_t access_point = 0;  // of RoomModel::access_points
  PersonScattering scattering;
  std::vector<std::complex<double>> empty;  // H0, [antenna][tone]
  std::complex<double> scale = 1.0;         // a
};

// What its access point heard.
struct PaperPersonMeasurement {
  const PaperPersonLink* link;
  std::vector<std::complex<double>> h;  // [antenna][tone], chain gains removed
  PaperCsiLoss::Observables observables;
};

// Thread safety: const members may be used from many threads.
class PaperPersonLoss {
 public:
  // What is passed outlives it. REQUIRES: a measurement.
  PaperPersonLoss(const RoomModel& room,
                  const PaperCsiLoss& csi_loss,
                  std::span<const PaperPersonMeasurement> measured,
                  double centre_weight);

  // Of the body's axis; the height does not count.
  LossInPlan at(const Vec3d& position) const;

  // Share of the power that the model at a place leaves unexplained, mean over the links [dB].
  double model_residual_db(const Vec3d& position) const;

 private:
  LossInPlan of_link(const PaperPersonMeasurement& measured, const Vec3d& position) const;
  std::vector<std::complex<double>> channel(
      const PaperPersonLink& link, const std::optional<std::vector<TargetPaths>>& added) const;

  const RoomModel& room_;
  const PaperCsiLoss& csi_loss_;
  std::span<const PaperPersonMeasurement> measured_;
  double centre_weight_;
};

}  // namespace rayloc
