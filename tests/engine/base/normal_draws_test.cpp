#include "engine/base/normal_draws.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <thread>
#include <vector>

namespace rayloc::normal_draws_test {
namespace {

constexpr std::size_t kCount = 65536;

std::vector<float> normals(std::uint64_t key, std::size_t count) {
  NormalDraws draws(key);
  std::vector<float> drawn(count);
  for (float& one : drawn) {
    one = draws.normal();
  }
  return drawn;
}

TEST(NormalDraws, FollowFromTheKeyAlone) {
  const auto here = normals(7, 1000);
  std::vector<float> there;
  std::thread([&] {
    normals(8, 100);
    there = normals(7, 1000);
  }).join();
  EXPECT_EQ(here, there);
  EXPECT_NE(here, normals(8, 1000));
}

TEST(NormalDraws, AreStandardNormal) {
  const auto drawn = normals(1, kCount);
  double sum = 0.0;
  double squares = 0.0;
  double product = 0.0;  // of neighbours
  double below_one = 0.0;
  double beyond_two = 0.0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const auto x = static_cast<double>(drawn[i]);
    sum += x;
    squares += x * x;
    product += x * static_cast<double>(drawn[(i + 1) % drawn.size()]);
    below_one += std::abs(x) < 1.0 ? 1.0 : 0.0;
    beyond_two += std::abs(x) > 2.0 ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(kCount);
  EXPECT_NEAR(sum / count, 0.0, 1e-3);
  EXPECT_NEAR(squares / count, 1.0, 5e-3);
  EXPECT_NEAR(product / count, 0.0, 0.015);
  EXPECT_NEAR(below_one / count, 0.6827, 0.006);
  EXPECT_NEAR(beyond_two / count, 0.0455, 0.003);
}

TEST(NormalDraws, AreUniform) {
  NormalDraws draws(3);
  std::array<int, 16> parts{};
  double sum = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::uint32_t bits = draws.bits16();
    ASSERT_LT(bits, 65536U);
    ++parts[bits >> 12U];
    const double u = draws.uniform();
    ASSERT_TRUE(u > 0.0 && u < 1.0);
    sum += u;
  }
  for (const int count : parts) {
    EXPECT_NEAR(count, 4096, 250);
  }
  EXPECT_NEAR(sum / static_cast<double>(kCount), 0.5, 0.005);
}

}  // namespace
}  // namespace rayloc::normal_draws_test
