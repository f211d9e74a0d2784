// One transmitter at one access point: its expected array, and the arrays received in windows.
#pragma once

#include <complex>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/monitor/calibration_monitor.h"
#include "engine/room/ray.h"

namespace rayloc {

struct MonitoredPoint {
  CalibrationMonitor::Transmitter transmitter;
  std::vector<Ray> rays;
  std::vector<std::complex<double>> expected;
  double known_share = 1.0;                 // of its power, PointArrays::known_share()
  std::vector<double> sigma;                // [rad], PointArrays::place_phase_sigma()
  std::vector<CsiFrame> frames;             // of the window
  std::vector<std::complex<double>> usual;  // phasor of each chain in the first windows
  bool settled = false;                     // two windows in a row agreed about `usual`
};

// Array that an access point received from one point in a window, chains removed.
struct ReceivedPoint {
  MonitoredPoint* point = nullptr;
  std::vector<std::complex<double>> h;
};
using ReceivedPoints = std::vector<ReceivedPoint>;

// [rad], phase - other in (-pi, pi].
double phase_difference(double phase, double other);

// Accepts windows as usual when two in a row agree; a person who walks by spoils single ones.
// `phasor`: of each chain in the last window.
void settle(MonitoredPoint& point, const std::vector<std::complex<double>>& phasor);

}  // namespace rayloc
