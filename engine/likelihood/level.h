// The level of a burst as one more Gaussian of its likelihood (METHODS B2, end):
//
//   ll = -(L - L_p - offset)^2 / (2 sigma^2)
//
// with L the level that the receiver states [dB], L_p the power that is traced at a place and
// diffuse power with it, offset and sigma of access point and transmitter (TransmitterLevel).
// Powers add without their phases: what a fade is above or below that is part of sigma, and so L_p
// hardly changes within a cell of the grid. Sigma was measured, so RoomModel::likelihood_exponent
// does not apply.
#pragma once

#include <optional>
#include <span>

#include "engine/observe/burst.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

// L_p [dB], of a transmitter of unit amplitude. REQUIRES: a ray.
double traced_level_db(std::span<const Ray> rays, const ModelError& error);

// What a burst says of L_p.
struct HeardLevel {
  double traced_db = 0.0;  // L - offset
  double sigma_db = 1.0;

  double log_likelihood(double traced_level_db) const;
};

// Nothing where the level of the burst's transmitter was not learned, or the burst states none.
std::optional<HeardLevel> heard_level(const RoomAccessPoint& access_point,
                                      const BurstObservation& burst);

}  // namespace rayloc
