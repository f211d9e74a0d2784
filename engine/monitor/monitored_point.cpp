#include "engine/monitor/monitored_point.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace rayloc {

double phase_difference(double phase, double other) {
  return std::remainder(phase - other, 2.0 * std::numbers::pi);
}

void settle(MonitoredPoint& point, const std::vector<std::complex<double>>& phasor) {
  if (point.settled) {
    return;
  }
  bool agrees = !point.usual.empty();
  for (std::size_t m = 1; agrees && m < phasor.size(); ++m) {
    const double now = std::arg(phasor[m] * std::conj(phasor[0]));
    const double before = std::arg(point.usual[m] * std::conj(point.usual[0]));
    agrees = std::abs(phase_difference(now, before)) < 0.5 * CalibrationMonitor::kJump;
  }
  point.settled = agrees;
  if (!agrees) {
    point.usual = phasor;
  }
}

}  // namespace rayloc
