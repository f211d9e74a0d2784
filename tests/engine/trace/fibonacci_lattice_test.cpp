#include "engine/trace/images/fibonacci_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace rayloc::fibonacci_lattice_test {
namespace {

std::vector<Vec3d> all_directions(const FibonacciLattice& lattice) {
  std::vector<Vec3d> all;
  std::vector<Vec3d> ring;
  for (std::size_t i = 0; i < lattice.rings(); ++i) {
    lattice.directions(i, ring);
    all.insert(all.end(), ring.begin(), ring.end());
  }
  return all;
}

TEST(FibonacciLattice, HoldsEveryDirectionOfTheLatticeOnce) {
  for (const std::size_t size : {1U, 2U, 7U, 1000U, 12'345U}) {
    auto directions = all_directions(FibonacciLattice(size));
    ASSERT_EQ(directions.size(), size);
    std::sort(directions.begin(), directions.end(), [](const Vec3d& a, const Vec3d& b) {
      return a.z > b.z;
    });
    for (std::size_t i = 0; i < size; ++i) {
      const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(size);
      const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
      const double azimuth = golden_angle * static_cast<double>(i);
      const double across = std::sqrt(1.0 - z * z);
      EXPECT_NEAR(directions[i].z, z, 1e-15);
      EXPECT_NEAR(directions[i].x, across * std::cos(azimuth), 1e-10);
      EXPECT_NEAR(directions[i].y, across * std::sin(azimuth), 1e-10);
    }
  }
}

// The mean angle between successive directions is a few times that between neighbours.
TEST(FibonacciLattice, SuccessiveDirectionsAreNeighbours) {
  constexpr std::size_t kSize = 100'000;
  const auto directions = all_directions(FibonacciLattice(kSize));
  double sum = 0.0;
  for (std::size_t i = 1; i < kSize; ++i) {
    sum += norm(directions[i] - directions[i - 1]);
  }
  const double spacing = std::sqrt(4.0 * std::numbers::pi / static_cast<double>(kSize));
  EXPECT_LT(sum / static_cast<double>(kSize), 3.0 * spacing);
}

}  // namespace
}  // namespace rayloc::fibonacci_lattice_test
