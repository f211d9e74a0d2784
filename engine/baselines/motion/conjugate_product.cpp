#include "engine/baselines/motion/conjugate_product.h"

#include <cmath>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr double kReferenceGain = 1000.0;  // of the mean least amplitude, of the published release
constexpr double kMinAmplitudeSpread = 1e-12;  // of an amplitude that never varies, a share

std::size_t steadiest(const Eigen::MatrixXd& amplitude, std::size_t antennas) {
  const Eigen::Index tones = amplitude.rows() / static_cast<Eigen::Index>(antennas);
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t m = 0; m < antennas; ++m) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < tones; ++k) {
      const auto row = amplitude.row(static_cast<Eigen::Index>(m) * tones + k);
      const double mean = row.mean();
      const double variance = (row.array() - mean).square().mean();
      sum += mean / (std::sqrt(variance) + kMinAmplitudeSpread * mean);
    }
    if (sum > most) {
      most = sum;
      best = m;
    }
  }
  return best;
}

}  // namespace

ConjugateProduct conjugate_product(const Eigen::MatrixXcd& h, std::size_t antennas) {
  RAYLOC_CHECK(antennas > 1 && h.cols() > 0);
  const Eigen::Index tones = h.rows() / static_cast<Eigen::Index>(antennas);
  const Eigen::MatrixXd amplitude = h.cwiseAbs();
  const Eigen::VectorXd least = amplitude.rowwise().minCoeff();
  const double beta = kReferenceGain * least.mean();
  ConjugateProduct result;
  result.reference = steadiest(amplitude, antennas);
  const Eigen::Index first = static_cast<Eigen::Index>(result.reference) * tones;
  result.product.resize(h.rows(), h.cols());
  for (Eigen::Index t = 0; t < h.cols(); ++t) {
    for (Eigen::Index i = 0; i < h.rows(); ++i) {
      const Eigen::Index r = first + i % tones;
      const double own = amplitude(i, t) - least(i);
      const double reference = amplitude(r, t) + beta;
      const std::complex<double> turn = h(i, t) * std::conj(h(r, t));
      const double size = std::abs(turn);
      result.product(i, t) = size > 0.0 ? own * reference / size * turn : 0.0;
    }
  }
  return result;
}

}  // namespace rayloc
