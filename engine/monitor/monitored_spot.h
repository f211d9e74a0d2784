// One transmitter at one access point: its expected array, and the arrays received in windows.
#pragma once

#include <complex>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/monitor/calibration_monitor.h"
#include "engine/room/ray.h"

namespace rayloc {

struct MonitoredSpot {
  CalibrationMonitor::Transmitter transmitter;
  std::vector<Ray> rays;
  std::vector<std::complex<double>> expected;
  double known_share = 1.0;                 // of its power, SpotArrays::known_share()
  std::vector<double> sigma;                // [rad], SpotArrays::place_phase_sigma()
  std::vector<CsiFrame> frames;             // of the window
  std::vector<std::complex<double>> usual;  // phasor of each chain in the first windows
  bool settled = false;                     // two windows in a row agreed about `usual`
};

// Array that an access point received from one spot in a window, chains removed.
struct ReceivedSpot {
  MonitoredSpot* spot = nullptr;
  std::vector<std::complex<double>> h;
};
using ReceivedSpots = std::vector<ReceivedSpot>;

// [rad], phase - other in (-pi, pi].
double phase_difference(double phase, double other);

// Accepts windows as usual when two in a row agree; a person who walks by spoils single ones.
// `phasor`: of each chain in the last window.
void settle(MonitoredSpot& spot, const std::vector<std::complex<double>>& phasor);

}  // namespace rayloc
