#include "engine/baselines/paths/smoothed_csi.h"

namespace rayloc {

SmoothingWindow smoothing_window(const Eigen::MatrixXcd& h) { return {2, h.cols() / 2}; }

Eigen::MatrixXcd smoothed_csi(const Eigen::MatrixXcd& h, const SmoothingWindow& window) {
  const Eigen::Index antenna_places = h.rows() - window.antennas + 1;
  const Eigen::Index tone_places = h.cols() - window.tones + 1;
  Eigen::MatrixXcd smoothed(window.size(), antenna_places * tone_places);
  for (Eigen::Index antenna = 0; antenna < antenna_places; ++antenna) {
    for (Eigen::Index tone = 0; tone < tone_places; ++tone) {
      auto column = smoothed.col(antenna * tone_places + tone);
      for (Eigen::Index m = 0; m < window.antennas; ++m) {
        column.segment(m * window.tones, window.tones) =
            h.row(antenna + m).segment(tone, window.tones).transpose();
      }
    }
  }
  return smoothed;
}

}  // namespace rayloc
