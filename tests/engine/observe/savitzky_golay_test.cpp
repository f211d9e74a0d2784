#include "engine/observe/savitzky_golay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/golden.h"

namespace rayloc::savitzky_golay_test {
namespace {

using Value = std::complex<double>;

std::vector<double> numbers(int first, int last) {
  std::vector<double> position;
  for (int k = first; k <= last; ++k) {
    position.push_back(k);
  }
  return position;
}

// Tones of a 40 MHz frame: none from -1 to 1.
std::vector<double> tones_with_a_gap() {
  std::vector<double> position = numbers(-58, -2);
  const auto upper = numbers(2, 58);
  position.insert(position.end(), upper.begin(), upper.end());
  return position;
}

std::vector<Value> values_of(const nlohmann::json& pairs) {
  std::vector<Value> values;
  for (const auto& pair : pairs) {
    values.emplace_back(pair[0].get<double>(), pair[1].get<double>());
  }
  return values;
}

std::vector<Value> noise(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Value> values(size);
  for (Value& v : values) {
    v = {normal(random), normal(random)};
  }
  return values;
}

TEST(SavitzkyGolay, SmoothsAsScipyDoes) {
  for (const auto& one : test::golden("savitzky_golay/smoothed")) {
    const auto row = values_of(one["row"]);
    const auto expected = values_of(one["smooth"]);
    const SavitzkyGolay smoother(numbers(5, 4 + static_cast<int>(row.size())),
                                 {one["window"].get<int>(), one["order"].get<int>()});
    const auto smooth = smoother.smooth(row);
    for (std::size_t i = 0; i < row.size(); ++i) {
      EXPECT_NEAR(std::abs(smooth[i] - expected[i]), 0.0, 1e-12) << one["window"] << " at " << i;
    }
  }
}

TEST(SavitzkyGolay, KeepsAPolynomialAcrossTheGap) {
  const auto position = tones_with_a_gap();
  std::vector<Value> cubic;
  for (const double k : position) {
    const double x = k / 58.0;
    cubic.emplace_back(1.0 - 2.0 * x + 3.0 * x * x * x, 0.5 * x * x);
  }
  const auto smooth = SavitzkyGolay(position, {11, 3}).smooth(cubic);
  for (std::size_t i = 0; i < cubic.size(); ++i) {
    EXPECT_NEAR(std::abs(smooth[i] - cubic[i]), 0.0, 1e-12) << position[i];
  }
}

TEST(SavitzkyGolay, AdjointIsTheTranspose) {
  const auto position = tones_with_a_gap();
  const SavitzkyGolay smoother(position, {9, 2});
  const auto a = noise(position.size(), 1);
  const auto b = noise(position.size(), 2);
  const auto smooth = smoother.smooth(a);
  const auto back = smoother.adjoint(b);
  double forward = 0.0;
  double backward = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    forward += (std::conj(b[i]) * smooth[i]).real();
    backward += (std::conj(back[i]) * a[i]).real();
  }
  EXPECT_NEAR(forward, backward, 1e-12 * std::abs(forward));
}

TEST(SavitzkyGolay, TakesAllOfARowThatIsShorterThanItsWindow) {
  const std::vector<Value> row = {1.0, 4.0, 9.0};
  const auto smooth = SavitzkyGolay(numbers(1, 3), {11, 3}).smooth(row);
  for (std::size_t i = 0; i < row.size(); ++i) {
    EXPECT_NEAR(smooth[i].real(), row[i].real(), 1e-12);
  }
}

TEST(SavitzkyGolay, RefusesWindowsThatThereAreNot) {
  EXPECT_TRUE(validate(SavitzkyGolayOptions{1, 0}));
  for (const SavitzkyGolayOptions& bad :
       {SavitzkyGolayOptions{10, 3}, {-1, 0}, {0, 0}, {5, 5}, {5, -1}}) {
    const auto valid = validate(bad);
    ASSERT_FALSE(valid) << bad.window << " " << bad.order;
    EXPECT_EQ(valid.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace rayloc::savitzky_golay_test
