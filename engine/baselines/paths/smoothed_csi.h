// smoothed_csi: rearranges one frame as many snapshots of a smaller array, so that coherent paths
// can be separated [SF, figure 4]: every window of antennas and tones is a column.
//
// References: [SF] M. Kotaru et al., SpotFi, SIGCOMM 2015.
#pragma once

#include <Eigen/Core>

namespace rayloc {

// Antennas and tones of a window.
struct SmoothingWindow {
  Eigen::Index antennas = 0;
  Eigen::Index tones = 0;

  Eigen::Index size() const { return antennas * tones; }
};
// Two antennas and half of the tones: 30 values for 3 x 30.
SmoothingWindow smoothing_window(const Eigen::MatrixXcd& h);

// [antenna of the window * tones + tone of the window][place of the window]. REQUIRES: `h` has an
// antenna and a tone for the window.
Eigen::MatrixXcd smoothed_csi(const Eigen::MatrixXcd& h, const SmoothingWindow& window);

}  // namespace rayloc
