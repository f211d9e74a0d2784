// The received power of a burst as one more Gaussian of its likelihood (METHODS B2, end):
//
//   ll = -(L - L_p - offset)^2 / (2 sigma^2)
//
// with L the received power (RSSI) that the receiver reports [dB], L_p the traced power at a place
// including diffuse power, and offset and sigma those of access point and transmitter
// (TransmitterPower). Powers add without phases: the deviation of a fade from this sum is part of
// sigma, so L_p hardly changes within a cell of the grid. Sigma is a measured value, so
// RoomModel::likelihood_exponent does not apply.
#pragma once

#include <optional>
#include <span>

#include "engine/observe/burst.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

// L_p [dB], for a transmitter of unit amplitude. REQUIRES: at least one ray.
double traced_power_db(std::span<const Ray> rays, const ModelError& error);

// The received power of a burst as a measurement of L_p.
struct ReceivedPower {
  double traced_db = 0.0;  // L - offset
  double sigma_db = 1.0;

  double log_likelihood(double traced_power_db) const;
};

// Empty if the transmitter's power was not calibrated or if the burst reports no received power.
std::optional<ReceivedPower> received_power(const RoomAccessPoint& access_point,
                                            const BurstObservation& burst);

}  // namespace rayloc
