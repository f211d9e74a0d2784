#include "engine/baselines/paths/path_loss_law.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rayloc {
namespace {

constexpr std::size_t kMinPowerPlaces = 10;  // a count, chosen: as for RayLoc's own power offsets
constexpr double kMinRangeSpread = 1e-4;  // of log10 r, squared, chosen: all are equally far away
constexpr double kMinFarDistance = 0.1;   // [m], chosen: nearer is no far field
constexpr double kMinPowerSigma = 0.5;    // [dB], chosen: receivers report whole dBm

double decades(double distance) { return std::log10(std::max(distance, kMinFarDistance)); }

}  // namespace

double PathLossLaw::at(double distance) const {
  return at_1m_dbm - 10.0 * exponent * decades(distance);
}

std::optional<PathLossLaw> fit_path_loss_law(std::span<const PowerAtDistance> places) {
  if (places.size() < kMinPowerPlaces) {
    return std::nullopt;
  }
  const auto count = static_cast<double>(places.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (const PowerAtDistance& place : places) {
    mean_x += decades(place.distance) / count;
    mean_y += place.power_dbm / count;
  }
  double xx = 0.0;
  double xy = 0.0;
  for (const PowerAtDistance& place : places) {
    const double x = decades(place.distance) - mean_x;
    xx += x * x;
    xy += x * (place.power_dbm - mean_y);
  }
  if (xx < kMinRangeSpread * count) {
    return std::nullopt;
  }
  PathLossLaw law;
  law.exponent = -0.1 * xy / xx;
  law.at_1m_dbm = mean_y + 10.0 * law.exponent * mean_x;
  double squares = 0.0;
  for (const PowerAtDistance& place : places) {
    const double off = place.power_dbm - law.at(place.distance);
    squares += off * off;
  }
  law.sigma_db = std::max(kMinPowerSigma, std::sqrt(squares / (count - 2.0)));
  return law;
}

}  // namespace rayloc
