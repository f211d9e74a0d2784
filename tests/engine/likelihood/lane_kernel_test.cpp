#include "engine/likelihood/lane_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Dense>

namespace rayloc::lane_kernel_test {
namespace {

using Single = std::complex<float>;

class Random {
 public:
  Single value() { return {normal_(random_), normal_(random_)}; }
  std::vector<Single> values(std::size_t count) {
    std::vector<Single> result(count);
    for (Single& one : result) {
      one = value();
    }
    return result;
  }
  std::vector<LaneRow> rows(std::size_t count) {
    std::vector<LaneRow> result(count);
    for (LaneRow& row : result) {
      for (float& one : row) {
        one = normal_(random_);
      }
    }
    return result;
  }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<float> normal_;
};

// An odd number of coordinates has a row of the triangle left over.
TEST(LaneKernel, WhitensAsEigenDoes) {
  for (const std::size_t size : {1U, 2U, 7U, 18U, 30U}) {
    Random random;
    const auto w = random.values(size * (size + 1) / 2);
    const auto re = random.rows(size);
    const auto im = random.rows(size);
    const auto along = random.values(3 * size);
    std::vector<LaneSums> sums(3);
    const LaneRow power = whiten(w.data(), re, im, along, sums);
    const auto d = static_cast<Eigen::Index>(size);
    Eigen::MatrixXcd triangle = Eigen::MatrixXcd::Zero(d, d);
    std::size_t next = 0;
    for (Eigen::Index i = 0; i < d; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        triangle(i, j) = std::complex<double>(w[next++]);
      }
    }
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      Eigen::VectorXcd x(d);
      for (std::size_t i = 0; i < size; ++i) {
        x(static_cast<Eigen::Index>(i)) = {static_cast<double>(re[i][t]),
                                           static_cast<double>(im[i][t])};
      }
      const Eigen::VectorXcd white = triangle * x;
      const double expected = white.squaredNorm();
      EXPECT_NEAR(static_cast<double>(power[t]), expected, 1e-5 * expected);
      for (std::size_t k = 0; k < sums.size(); ++k) {
        std::complex<double> product;
        for (std::size_t i = 0; i < size; ++i) {
          product += std::conj(white(static_cast<Eigen::Index>(i))) *
                     std::complex<double>(along[k * size + i]);
        }
        const double scale = 1e-5 * (white.norm() * 10.0 + 1.0);
        EXPECT_NEAR(static_cast<double>(sums[k].re[t]), product.real(), scale);
        EXPECT_NEAR(static_cast<double>(sums[k].im[t]), product.imag(), scale);
      }
    }
  }
}

TEST(LaneKernel, FindsTheBestGain) {
  const LaneRow power{0.5F, 3.0F, 20.0F, 300.0F, 1e-12F, 18.0F, 1e4F, 40.0F};
  const LaneSums along{{0.0F, 1.0F, -20.0F, 90.0F, 0.0F, 7.0F, 300.0F, -3.0F},
                       {0.0F, 2.0F, 15.0F, -250.0F, 0.0F, 7.0F, 9e3F, 4.0F}};
  const LaneRow values = at_best_gain(power, along, 18);
  for (std::size_t t = 0; t < kLaneCount; ++t) {
    const auto a = static_cast<double>(power[t]);
    const double b = std::hypot(static_cast<double>(along.re[t]), static_cast<double>(along.im[t]));
    const auto at = [&](double r) { return 36.0 * std::log(r) - r * r * a + 2.0 * r * b; };
    const double best = (b + std::sqrt(b * b + 72.0 * a)) / (2.0 * a);
    EXPECT_GE(at(best), std::max(at(1.01 * best), at(best / 1.01)));
    EXPECT_NEAR(static_cast<double>(values[t]), at(best), 1e-5 * (100.0 + std::abs(at(best))));
  }
}

TEST(LaneKernel, SumsRotatedMeans) {
  constexpr std::size_t kTerms = 5;
  constexpr std::size_t kSize = 6;
  Random random;
  const auto mean = random.values(kTerms * kSize);
  const auto turn = random.values(kTerms);
  std::vector<LaneSums> turns(kTerms);
  std::vector<RotatedMean> terms(kTerms);
  for (std::size_t s = 0; s < kTerms; ++s) {
    turns[s] = {random.rows(1)[0], random.rows(1)[0]};
    terms[s] = {turn[s], &turns[s], mean.data() + s * kSize};
  }
  auto re = random.rows(kSize);
  auto im = random.rows(kSize);
  const auto before_re = re;
  const auto before_im = im;
  add_rotated(terms, re, im);
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      std::complex<double> expected(static_cast<double>(before_re[i][t]),
                                    static_cast<double>(before_im[i][t]));
      for (std::size_t s = 0; s < kTerms; ++s) {
        expected += std::complex<double>(turn[s]) *
                    std::complex<double>(static_cast<double>(turns[s].re[t]),
                                         static_cast<double>(turns[s].im[t])) *
                    std::complex<double>(mean[s * kSize + i]);
      }
      EXPECT_NEAR(static_cast<double>(re[i][t]), expected.real(), 1e-4);
      EXPECT_NEAR(static_cast<double>(im[i][t]), expected.imag(), 1e-4);
    }
  }
}

}  // namespace
}  // namespace rayloc::lane_kernel_test
