#include "engine/person/other_people.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "engine/likelihood/gaussian/covariance_factor.h"

namespace rayloc::other_people_test {
namespace {

using Value = std::complex<double>;
using Eigen::Index;

constexpr std::size_t kSize = 7;
constexpr Index kRows = static_cast<Index>(kSize);

std::vector<Value> random_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<Value> result(kSize);
  for (Value& value : result) {
    const double real = normal(random);
    value = {real, normal(random)};
  }
  return result;
}

Eigen::VectorXcd as_eigen(const std::vector<Value>& x) {
  return Eigen::Map<const Eigen::VectorXcd>(x.data(), static_cast<Index>(x.size()));
}

// A Gaussian, co-occupants, and the covariance of both together, written out.
struct Accompanied {
  WhitenedGaussian gaussian;
  OtherPeople co_occupants;
  Eigen::MatrixXcd sigma;
};

Accompanied make(std::size_t columns, std::mt19937& random) {
  Accompanied made;
  Eigen::MatrixXcd root(kRows, kRows);
  for (Index i = 0; i < kRows; ++i) {
    root.col(i) = as_eigen(random_vector(random));
  }
  made.sigma = root * root.adjoint() + Eigen::MatrixXcd::Identity(kRows, kRows);
  made.gaussian = CovarianceFactor(made.sigma).gaussian();
  made.co_occupants.added = random_vector(random);
  for (std::size_t c = 0; c < columns; ++c) {
    made.co_occupants.spread.push_back(random_vector(random));
    const Eigen::VectorXcd s = as_eigen(made.co_occupants.spread.back());
    made.sigma += s * s.adjoint();
  }
  return made;
}

// The whitener is kept in single precision.
constexpr double kClose = 1e-5;

class OtherPeopleTest : public ::testing::TestWithParam<std::size_t> {};

TEST_P(OtherPeopleTest, IsTheGaussianOfBothTogether) {
  std::mt19937 random(1);
  const Accompanied made = make(GetParam(), random);
  const AccompaniedGaussian with(made.gaussian, made.co_occupants);
  const Eigen::LLT<Eigen::MatrixXcd> together(made.sigma);

  double log_determinant = 0.0;
  const Eigen::MatrixXcd lower = together.matrixL();
  for (Index i = 0; i < kRows; ++i) {
    log_determinant += 2.0 * std::log(lower(i, i).real());
  }
  EXPECT_NEAR(made.gaussian.log_determinant + with.log_determinant(), log_determinant, kClose);

  for (int i = 0; i < 5; ++i) {
    const auto x = random_vector(random);
    const auto y = random_vector(random);
    const auto u = whiten(made.gaussian, x);
    const Eigen::VectorXcd inverse = together.solve(as_eigen(y));
    const Value expected = as_eigen(x).dot(inverse);
    const Value found = inner_product(u, with.reduced(whiten(made.gaussian, y)));
    EXPECT_NEAR(std::abs(found - expected), 0.0, kClose * (1.0 + std::abs(expected)));

    const double power = as_eigen(x).dot(together.solve(as_eigen(x))).real();
    EXPECT_NEAR(with.power(u), power, kClose * (1.0 + power));
  }
  const auto shift = whiten(made.gaussian, made.co_occupants.added);
  for (std::size_t k = 0; k < kSize; ++k) {
    EXPECT_EQ(with.shift()[k], shift[k]);
  }
}

INSTANTIATE_TEST_SUITE_P(Columns,
                         OtherPeopleTest,
                         ::testing::Values(0U, 1U, 3U, OtherPeople::kMaxColumns));

}  // namespace
}  // namespace rayloc::other_people_test
