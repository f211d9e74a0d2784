// LevelLaw: how the level that a receiver states falls with distance, level = at_1m - 10 n log10 r,
// learned from places that are known.
#pragma once

#include <optional>
#include <span>

namespace rayloc {

// n of a furnished room where nothing was learned: a ratio, chosen between free space (2) and a
// closed box, whose walls keep the power.
inline constexpr double kUsualExponent = 1.8;
inline constexpr double kUsualLevelSigma = 3.0;  // [dB], about that line: fades of a room, chosen

struct LevelLaw {
  double at_1m_dbm = 0.0;  // of a transmitter that never changes its power
  double exponent = kUsualExponent;
  double sigma_db = kUsualLevelSigma;  // standard deviation, from place to place

  double at(double distance) const;  // [dBm], distance [m]
};

struct LevelAtDistance {
  double distance = 1.0;  // [m]
  double level_dbm = 0.0;
};

// By least squares; nothing of fewer than 10 places or where all are equally far away.
std::optional<LevelLaw> fit_level_law(std::span<const LevelAtDistance> places);

}  // namespace rayloc
