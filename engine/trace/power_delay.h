// Total power, mean delay and delay spread of arrivals (ITU-R P.1407-8).
#pragma once

#include <cmath>

namespace rayloc {

struct PowerDelay {
  double power = 0.0;
  double mean_delay = 0.0;    // [s], 0 without power
  double delay_spread = 0.0;  // [s], root mean square about the mean
};

// `arrivals`: elements with a `tau` [s]; `power_of`: the power of one of them.
template <typename Arrivals, typename PowerOf>
PowerDelay power_delay(const Arrivals& arrivals, const PowerOf& power_of) {
  PowerDelay found;
  double mean = 0.0;
  for (const auto& one : arrivals) {
    found.power += power_of(one);
    mean += power_of(one) * one.tau;
  }
  if (!(found.power > 0.0)) {
    return found;
  }
  found.mean_delay = mean / found.power;
  // Computed about the mean, since the spread is small compared with the delays.
  double variance = 0.0;
  for (const auto& one : arrivals) {
    const double late = one.tau - found.mean_delay;
    variance += power_of(one) * late * late;
  }
  found.delay_spread = std::sqrt(variance / found.power);
  return found;
}

}  // namespace rayloc
