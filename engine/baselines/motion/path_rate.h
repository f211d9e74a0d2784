// path_rates: the rate at which the length of the path via a walking person grows, from the ratio
// of two antennas of one access point [WT].
//
// Relative to the static part, the ratio moves on a circle, once for each wavelength of the path: q
// = c + r exp(-j 2 pi L / wavelength). The phase of its tangent rotates with the path, for any
// centre of the circle. The weaker antenna is the numerator and the stronger one the denominator,
// so that the pole is outside the circle and the sense of rotation is kept.
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
  double sign_s = 0.15;  // window of the sense of rotation
};

struct PathRate {
  double rate = 0.0;   // [m/s], positive: the length grows
  double score = 0.0;  // increases with the evenness of the rotation; in any unit
};

// Minimum samples in the window of the smoothing.
inline constexpr int kMinSmoothing = 5;

// One for each sample; values within half a window of each end are less accurate. `ratio`: of one
// tone, `step_s` apart. REQUIRES: a window of kMinSmoothing samples.
std::vector<PathRate> path_rates(std::span<const std::complex<double>> ratio,
                                 double step_s,
                                 double wavelength,
                                 const PathRateOptions& options = {});

}  // namespace rayloc
