// PersonLoss: the loss of the paper's device-free localization for a person at a place, and
// its gradient from the tracer's derivatives (METHODS A4; formula: PersonLocalizer).
//
// The channel with a person is that of the measured empty room plus the contribution of a body at
// the place: H0 + a dH(P) of PersonReference. A body that contains the transmitter or an antenna
// has no defined contribution: the channel there is H0.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/paper/csi_loss.h"
#include "engine/paper/descent.h"
#include "engine/person/person_scattering.h"
#include "engine/room/room_model.h"

namespace rayloc::paper {

// A usable link of the reference.
struct UsableLink {
  std::size_t access_point = 0;  // index in RoomModel::access_points
  PersonScattering scattering;
  std::vector<std::complex<double>> empty;  // H0, [antenna][tone]
  std::complex<double> scale = 1.0;         // a
};

// Burst received by the access point of a link.
struct PersonMeasurement {
  const UsableLink* link;
  std::vector<std::complex<double>> h;  // [antenna][tone], chain gains removed
  CsiLoss::Observables observables;
};

// Thread safety: const members may be used from many threads.
class PersonLoss {
 public:
  // The arguments must outlive it. REQUIRES: at least one measurement.
  PersonLoss(const RoomModel& room,
             const CsiLoss& csi_loss,
             std::span<const PersonMeasurement> measured,
             double centre_weight);

  // For the body's axis; the height is ignored.
  LossInPlan at(const Vec3d& position) const;

  // Unexplained share of the power for a person at a place, mean over the links [dB].
  double model_residual_db(const Vec3d& position) const;

 private:
  LossInPlan of_link(const PersonMeasurement& measured, const Vec3d& position) const;
  std::vector<std::complex<double>> channel(
      const UsableLink& link, const std::optional<std::vector<TargetPaths>>& added) const;

  const RoomModel& room_;
  const CsiLoss& csi_loss_;
  std::span<const PersonMeasurement> measured_;
  double centre_weight_;
};

}  // namespace rayloc::paper
