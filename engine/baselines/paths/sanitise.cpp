#include "engine/baselines/paths/sanitise.h"

#include <cmath>
#include <complex>

#include "engine/baselines/paths/turn.h"

namespace rayloc {
namespace {

using std::complex;

// Phase step from tone to tone of the sum over antennas, in turns: exact for a common delay.
double common_turn(const Eigen::MatrixXcd& h) {
  complex<double> sum = 0.0;
  for (Eigen::Index m = 0; m < h.rows(); ++m) {
    for (Eigen::Index k = 0; k + 1 < h.cols(); ++k) {
      sum += std::conj(h(m, k)) * h(m, k + 1);
    }
  }
  return std::arg(sum);
}

// Each antenna's phase along the tones; its first value is within half a turn of antenna 0's.
Eigen::MatrixXd unwrapped(const Eigen::MatrixXcd& h) {
  Eigen::MatrixXd phase(h.rows(), h.cols());
  for (Eigen::Index m = 0; m < h.rows(); ++m) {
    const complex<double> before = m == 0 ? complex<double>(1.0) : h(0, 0);
    phase(m, 0) = (m == 0 ? 0.0 : phase(0, 0)) + std::arg(h(m, 0) * std::conj(before));
    for (Eigen::Index k = 1; k < h.cols(); ++k) {
      phase(m, k) = phase(m, k - 1) + std::arg(h(m, k) * std::conj(h(m, k - 1)));
    }
  }
  return phase;
}

}  // namespace

Eigen::MatrixXcd sanitised(const Eigen::MatrixXcd& h) {
  const auto tones = static_cast<double>(h.cols());
  const double coarse = common_turn(h);
  // Tones relative to the middle of the comb, so that slope and offset are uncorrelated.
  const auto at = [&](Eigen::Index k) { return static_cast<double>(k) - 0.5 * (tones - 1.0); };
  Eigen::MatrixXcd flat = h;
  for (Eigen::Index k = 0; k < h.cols(); ++k) {
    flat.col(k) *= turn(-coarse * at(k));
  }
  const Eigen::MatrixXd phase = unwrapped(flat);
  double slope = 0.0;
  double squares = 0.0;
  for (Eigen::Index k = 0; k < h.cols(); ++k) {
    slope += at(k) * phase.col(k).sum();
    squares += at(k) * at(k) * static_cast<double>(h.rows());
  }
  slope /= squares;
  const double offset = phase.mean();
  for (Eigen::Index k = 0; k < h.cols(); ++k) {
    flat.col(k) *= turn(-offset - slope * at(k));
  }
  return flat;
}

}  // namespace rayloc
