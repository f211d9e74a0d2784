// path_rates: how fast the path by way of somebody who walks gets longer, from the ratio of two
// antennas of one access point [WT].
//
// Beside what does not move the ratio runs around a circle, once for each wavelength of the path:
// q = c + r exp(-j 2 pi L / wavelength). The phase of its tangent turns with the path, wherever the
// middle of the circle is. The weaker antenna stands over the stronger one, so that the pole is
// outside of the circle and the sense of turning is kept.
//
// References: [WT] D. Wu et al., WiTraj, IEEE TMC 2023.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace rayloc {

struct PathRateOptions {
  double smoothing_s =
      0.0275;            // window of the smoothing, a polynomial of second order, three times
  double sign_s = 0.15;  // window of the sense of turning
};

struct PathRate {
  double rate = 0.0;   // [m/s], positive: longer
  double score = 0.0;  // the evener the turning, the higher; in any unit
};

// Samples that the smoothing needs at least in its window.
inline constexpr int kLeastSmoothing = 5;

// One for each sample; within half a window of each end they are worth less. `ratio`: of one tone,
// `step_s` apart. REQUIRES: a window of kLeastSmoothing samples.
std::vector<PathRate> path_rates(std::span<const std::complex<double>> ratio,
                                 double step_s,
                                 double wavelength,
                                 const PathRateOptions& options = {});

}  // namespace rayloc
