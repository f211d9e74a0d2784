// Arrays of a few plane waves, written down from the formula of a path alone: psi = 2 pi d
// sin(angle) from antenna to antenna, and exp(-j 2 pi f tau) along the tones.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <random>
#include <span>

#include <Eigen/Core>

namespace rayloc::test {

struct PlaneWave {
  double psi = 0.0;  // [rad]
  double tau = 0.0;  // [s]
  std::complex<double> amplitude = 1.0;
};

// `step_hz`: from tone to tone, of 30; `noise_db`: of one value, below the first wave.
inline Eigen::MatrixXcd array_of(std::span<const PlaneWave> waves,
                                 double step_hz,
                                 double noise_db,
                                 Eigen::Index antennas = 3) {
  constexpr Eigen::Index kTones = 30;
  Eigen::MatrixXcd h = Eigen::MatrixXcd::Zero(antennas, kTones);
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, std::pow(10.0, -0.05 * noise_db) / std::sqrt(2.0));
  for (Eigen::Index m = 0; m < antennas; ++m) {
    for (Eigen::Index k = 0; k < kTones; ++k) {
      for (const PlaneWave& wave : waves) {
        h(m, k) += wave.amplitude * std::polar(1.0,
                                               wave.psi * static_cast<double>(m) -
                                                   2.0 * std::numbers::pi * wave.tau * step_hz *
                                                       static_cast<double>(k));
      }
      const double real = normal(random);
      h(m, k) += std::complex<double>(real, normal(random));
    }
  }
  return h;
}

}  // namespace rayloc::test
