// PathLossLaw: path-loss law of the received power over distance, power = at_1m - 10 n log10 r,
// learned from known positions.
#pragma once

#include <optional>
#include <span>

namespace rayloc {

// Default n of a furnished room without training: a ratio, chosen between free space (2) and a
// closed box, whose walls keep the power.
inline constexpr double kUsualExponent = 1.8;
inline constexpr double kUsualPowerSigma = 3.0;  // [dB], about that line: fading of a room, chosen

struct PathLossLaw {
  double at_1m_dbm = 0.0;  // of a transmitter with constant power
  double exponent = kUsualExponent;
  double sigma_db = kUsualPowerSigma;  // standard deviation, from place to place

  double at(double distance) const;  // [dBm], distance [m]
};

struct PowerAtDistance {
  double distance = 1.0;  // [m]
  double power_dbm = 0.0;
};

// By least squares; empty for fewer than 10 places or if all are equally far away.
std::optional<PathLossLaw> fit_path_loss_law(std::span<const PowerAtDistance> places);

}  // namespace rayloc
