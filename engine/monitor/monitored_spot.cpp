#include "engine/monitor/monitored_spot.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace rayloc {

double phase_difference(double phase, double other) {
  return std::remainder(phase - other, 2.0 * std::numbers::pi);
}

void settle(MonitoredSpot& spot, const std::vector<std::complex<double>>& phasor) {
  if (spot.settled) {
    return;
  }
  bool agrees = !spot.usual.empty();
  for (std::size_t m = 1; agrees && m < phasor.size(); ++m) {
    const double now = std::arg(phasor[m] * std::conj(phasor[0]));
    const double before = std::arg(spot.usual[m] * std::conj(spot.usual[0]));
    agrees = std::abs(phase_difference(now, before)) < 0.5 * CalibrationMonitor::kJump;
  }
  spot.settled = agrees;
  if (!agrees) {
    spot.usual = phasor;
  }
}

}  // namespace rayloc
