#include "engine/calibrate/chain_ripple.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/QR>

#include "engine/base/check.h"
#include "engine/base/parallel.h"
#include "engine/observe/unit_power.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr int kRippleIterations = 6;  // a count, chosen: alternates phases of frames and gains
// Gains are smooth over the tones: polynomials up to this degree (a ripple over the band).
constexpr int kGainDegree = 4;

// Replaces each row of [rx_chain][tone] by its least-squares polynomial over the tones.
class ToneSmoother {
 public:
  explicit ToneSmoother(const OfdmGrid& grid) {
    const auto tones = static_cast<Eigen::Index>(grid.size());
    const double half = 0.5 * (grid.tone_index.back() - grid.tone_index.front());
    const double middle = 0.5 * (grid.tone_index.back() + grid.tone_index.front());
    const auto columns = std::min<Eigen::Index>(kGainDegree + 1, tones);
    Eigen::MatrixXd powers(tones, columns);
    for (Eigen::Index k = 0; k < tones; ++k) {
      const double x = (grid.tone_index[static_cast<std::size_t>(k)] - middle) / half;
      for (Eigen::Index degree = 0; degree < columns; ++degree) {
        powers(k, degree) = std::pow(x, static_cast<double>(degree));
      }
    }
    basis_ = powers.householderQr().householderQ() * Eigen::MatrixXd::Identity(tones, columns);
  }

  void smooth(std::vector<Value>& values) const {
    const Eigen::Index tones = basis_.rows();
    for (std::size_t row = 0; row < values.size(); row += static_cast<std::size_t>(tones)) {
      Eigen::Map<Eigen::VectorXcd> v(values.data() + row, tones);
      const Eigen::VectorXcd coordinates = basis_.transpose() * v;
      v = basis_ * coordinates;
    }
  }

 private:
  Eigen::MatrixXd basis_;
};

// Measured times the conjugate of the expected, aligned to the gains times the expected power. Both
// are of unit power, so the factor is a phase; its magnitude is the weight, the correlation.
std::vector<Value> aligned_ratio(const Aligner& aligner,
                                 const std::vector<Value>& measured,
                                 const std::vector<Value>& expected,
                                 const std::vector<Value>& gain) {
  std::vector<Value> target(gain.size());
  std::vector<Value> ratio(gain.size());
  for (std::size_t j = 0; j < gain.size(); ++j) {
    ratio[j] = measured[j] * std::conj(expected[j]);
    target[j] = gain[j] * std::norm(expected[j]);
  }
  Alignment alignment = aligner.align(target, ratio);
  const double magnitude = std::abs(alignment.factor);
  alignment.factor *= magnitude > 0.0 ? alignment.correlation / magnitude : 0.0;
  aligner.apply(alignment, ratio);
  return ratio;
}

// Sigma of each chain [rad]: the scatter of the samples' own phases about the gains' phases, over
// the root of the number of samples.
std::vector<double> phase_sigma(const std::vector<Value>& gain,
                                const std::vector<std::vector<Value>>& ratio,
                                std::size_t tones) {
  std::vector<double> sigma;
  for (std::size_t row = 0; row < gain.size(); row += tones) {
    double scatter = 0.0;
    for (const auto& own : ratio) {
      Value along;
      for (std::size_t j = row; j < row + tones; ++j) {
        along += std::conj(gain[j]) * own[j];
      }
      const double angle = std::abs(along) > 0.0 ? std::arg(along) : std::numbers::pi;
      scatter += angle * angle;
    }
    sigma.push_back(std::sqrt(scatter) / static_cast<double>(ratio.size()));
  }
  return sigma;
}

}  // namespace

// Alternates between the delay and factor of every pair and the gains, which are then the weighted
// mean of measured over expected; the weight is the pair's correlation.
ChainRipple chain_ripple(const Aligner& aligner,
                         const OfdmGrid& grid,
                         std::vector<ArrayPair> pairs) {
  RAYLOC_CHECK(!pairs.empty());
  const std::size_t size = pairs.front().measured.size();
  const ToneSmoother smoother(grid);
  for (ArrayPair& pair : pairs) {
    scale_to_unit(pair.measured);
    scale_to_unit(pair.expected);
  }
  std::vector<Value> gain(size, Value(1.0));
  std::vector<std::vector<Value>> ratio(pairs.size());
  for (int iteration = 0; iteration < kRippleIterations; ++iteration) {
    parallel_for(pairs.size(), 4, [&](std::size_t i) {
      ratio[i] = aligned_ratio(aligner, pairs[i].measured, pairs[i].expected, gain);
    });
    std::vector<Value> sum(size);
    std::vector<double> weight(size, 1e-12);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        sum[j] += ratio[i][j];
        weight[j] += std::norm(pairs[i].expected[j]);
      }
    }
    for (std::size_t j = 0; j < size; ++j) {
      gain[j] = sum[j] / weight[j];
    }
    smoother.smooth(gain);
    scale_to_unit(gain);
  }
  return {gain, phase_sigma(gain, ratio, grid.size())};
}

}  // namespace rayloc
