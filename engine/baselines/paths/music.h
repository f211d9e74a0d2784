// Music: bearing and delay of the paths of one frame, by recursively applied and projected MUSIC
// [RM] on the smoothed array [SF].
//
// The bearing is a phase psi from one antenna to the next, never an angle: at more than half a
// wavelength several directions have the same phase. A path with phase psi and delay tau gives
// antenna m and tone l of the window exp(j (psi m - 2 pi l tau step_hz)).
//
// Thread safety: const members may be used from many threads.
// References: [RM] J. Mosher, R. Leahy, IEEE Trans. SP 47 (1999) 332. [SF] M. Kotaru et al.,
// SpotFi, SIGCOMM 2015.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "engine/baselines/paths/path_count.h"
#include "engine/baselines/paths/smoothed_csi.h"

namespace rayloc {

// One path estimated from a frame.
struct PathAtArray {
  double psi = 0.0;    // [rad], from one antenna to the next
  double tau = 0.0;    // [s], relative to the delay common to all paths
  double score = 0.0;  // cosine squared between it and the remaining signal; 1: inside the signal
};

struct MusicOptions {
  std::size_t psi_points = 101;  // on the circle
  std::size_t tau_points = 201;  // from -most_tau to most_tau
  double most_tau = 100e-9;      // [s]
  PathCountRule count = PathCountRule::kDrop;
};

class Music {
 public:
  // `window`: from smoothed_csi(); `step_hz`: of the comb.
  Music(const SmoothingWindow& window, double step_hz, const MusicOptions& options = {});

  // In the order of detection, the strongest first. `h`: [antenna][tone], sanitised.
  std::vector<PathAtArray> paths(const Eigen::MatrixXcd& h) const;

 private:
  struct Subspace;
  PathAtArray highest(const Subspace& space) const;
  PathAtArray refined(const Subspace& space, PathAtArray path) const;

  SmoothingWindow window_;
  double step_hz_ = 0.0;
  MusicOptions options_;
  Eigen::MatrixXcd antenna_;  // [psi][antenna], steering
  Eigen::MatrixXcd tone_;     // [tau][tone], steering
};

}  // namespace rayloc
