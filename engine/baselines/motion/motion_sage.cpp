#include "engine/baselines/motion/motion_sage.h"

#include <cmath>
#include <numbers>

#include "engine/baselines/paths/turn.h"
#include "engine/baselines/two_pi.h"

namespace rayloc {
namespace {

Eigen::VectorXd in_steps(double first, double last, double step) {
  const auto count = static_cast<Eigen::Index>(std::lround((last - first) / step)) + 1;
  return Eigen::VectorXd::LinSpaced(count, first, first + step * static_cast<double>(count - 1));
}

Eigen::Index highest(const Eigen::VectorXcd& sums) {
  Eigen::Index at = 0;
  sums.cwiseAbs2().maxCoeff(&at);
  return at;
}

}  // namespace

MotionSage::MotionSage(std::vector<double> tone_hz,
                       std::size_t antennas,
                       std::size_t instants,
                       double step_s,
                       double wavelength,
                       const MotionSageOptions& options)
    : antennas_(static_cast<Eigen::Index>(antennas)),
      rates_(in_steps(-options.most_rate, options.most_rate, options.rate_step)),
      delays_(in_steps(options.least_delay, options.most_delay, options.delay_step)),
      psis_(static_cast<Eigen::Index>(options.psi_points)),
      rounds_(options.rounds),
      paths_(options.paths) {
  rate_.resize(rates_.size(), static_cast<Eigen::Index>(instants));
  for (Eigen::Index i = 0; i < rate_.rows(); ++i) {
    for (Eigen::Index t = 0; t < rate_.cols(); ++t) {
      rate_(i, t) = turn(-kTwoPi * rates_(i) * step_s * static_cast<double>(t) / wavelength);
    }
  }
  delay_.resize(delays_.size(), static_cast<Eigen::Index>(tone_hz.size()));
  for (Eigen::Index i = 0; i < delay_.rows(); ++i) {
    for (Eigen::Index k = 0; k < delay_.cols(); ++k) {
      delay_(i, k) = turn(-kTwoPi * tone_hz[static_cast<std::size_t>(k)] * delays_(i));
    }
  }
  for (Eigen::Index i = 0; i < psis_.size(); ++i) {
    psis_(i) =
        kTwoPi * static_cast<double>(i) / static_cast<double>(psis_.size()) - std::numbers::pi;
  }
}

// [antenna * tones + tone].
Eigen::VectorXcd MotionSage::channel_of(const Index& at, std::size_t reference) const {
  const Eigen::Index tones = delay_.cols();
  Eigen::VectorXcd channel(antennas_ * tones);
  for (Eigen::Index m = 0; m < antennas_; ++m) {
    const double steps = static_cast<double>(m) - static_cast<double>(reference);
    channel.segment(m * tones, tones) =
        turn(psis_(at.psi) * steps) * delay_.row(at.delay).transpose();
  }
  return channel;
}

Eigen::VectorXcd MotionSage::over_channel(const Eigen::MatrixXcd& window,
                                          const Eigen::VectorXcd& in_time) const {
  return window * in_time.conjugate();
}

// Updates one coordinate after the other; a new path starts with the rate of most energy over all
// antennas and tones.
MotionSage::Index MotionSage::search(const Eigen::MatrixXcd& window,
                                     std::size_t reference,
                                     Index from,
                                     bool is_new) const {
  const Eigen::Index tones = delay_.cols();
  Index at = from;
  if (is_new) {
    const Eigen::MatrixXcd all = window * rate_.adjoint();  // [channel][rate]
    all.colwise().squaredNorm().maxCoeff(&at.rate);
    // Sums over antennas incoherently: their phase is not yet estimated.
    const Eigen::VectorXcd channel = all.col(at.rate);
    Eigen::VectorXd energy = Eigen::VectorXd::Zero(delay_.rows());
    for (Eigen::Index m = 0; m < antennas_; ++m) {
      energy += (delay_.conjugate() * channel.segment(m * tones, tones)).cwiseAbs2();
    }
    energy.maxCoeff(&at.delay);
  }
  const Eigen::VectorXcd channel = over_channel(window, rate_.row(at.rate).transpose());
  Eigen::VectorXcd of_antenna(antennas_);
  for (Eigen::Index m = 0; m < antennas_; ++m) {
    of_antenna(m) = delay_.row(at.delay).conjugate() * channel.segment(m * tones, tones);
  }
  Eigen::VectorXcd by_psi(psis_.size());
  for (Eigen::Index i = 0; i < psis_.size(); ++i) {
    std::complex<double> sum = 0.0;
    for (Eigen::Index m = 0; m < antennas_; ++m) {
      const double steps = static_cast<double>(m) - static_cast<double>(reference);
      sum += of_antenna(m) * turn(-psis_(i) * steps);
    }
    by_psi(i) = sum;
  }
  at.psi = highest(by_psi);
  Eigen::VectorXcd of_tone = Eigen::VectorXcd::Zero(tones);
  for (Eigen::Index m = 0; m < antennas_; ++m) {
    const double steps = static_cast<double>(m) - static_cast<double>(reference);
    of_tone += turn(-psis_(at.psi) * steps) * channel.segment(m * tones, tones);
  }
  at.delay = highest(delay_.conjugate() * of_tone);
  const Eigen::VectorXcd in_time =
      (channel_of(at, reference).adjoint() * window).transpose();  // [instant]
  at.rate = highest(rate_.conjugate() * in_time);
  return at;
}

std::vector<MotionPath> MotionSage::paths(const Eigen::MatrixXcd& window,
                                          std::size_t reference) const {
  const auto count = static_cast<double>(window.size());
  std::vector<Index> at(paths_);
  std::vector<std::complex<double>> amplitude(paths_);
  Eigen::MatrixXcd left = window;
  const auto model = [&](std::size_t i) -> Eigen::MatrixXcd {
    return amplitude[i] * channel_of(at[i], reference) * rate_.row(at[i].rate);
  };
  for (int round = 0; round < rounds_; ++round) {
    bool moved = false;
    for (std::size_t i = 0; i < paths_; ++i) {
      if (round > 0) {
        left += model(i);
      }
      const Index before = at[i];
      at[i] = search(left, reference, before, round == 0);
      const std::complex<double> sum = channel_of(at[i], reference).adjoint() *
                                       over_channel(left, rate_.row(at[i].rate).transpose());
      amplitude[i] = sum / count;
      left -= model(i);
      moved = moved || !(before == at[i]);
    }
    if (!moved) {
      break;
    }
  }
  std::vector<MotionPath> found;
  for (std::size_t i = 0; i < paths_; ++i) {
    found.push_back({rates_(at[i].rate),
                     delays_(at[i].delay),
                     psis_(at[i].psi),
                     std::norm(amplitude[i]) * count});
  }
  return found;
}

}  // namespace rayloc
