#include "engine/posterior/posterior.h"
#include "engine/grid/cell_mass.h"
#include "engine/grid/grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/posterior/smallest_half_mass_disc.h"

namespace rayloc::posterior_test {
namespace {

Grid grid() { return {{-2.0, -1.5, 0.0}, {2.0, 1.5, 2.5}, 1.2, 0.05}; }

double gaussian(const Vec3d& p, double x, double y, double sigma) {
  const double dx = (p.x - x) / sigma;
  const double dy = (p.y - y) / sigma;
  return -0.5 * (dx * dx + dy * dy);
}

template <typename Function>
std::vector<double> map_of(const Grid& g, const Function& function) {
  std::vector<double> map;
  for (std::size_t i = 0; i < g.size(); ++i) {
    map.push_back(function(g.centre(i)));
  }
  return map;
}

TEST(Posterior, HasTheMomentsAndRadiusOfAGaussian) {
  const Grid g = grid();
  const double sigma = 0.2;
  LocationEstimate estimate;
  summarise_posterior(
      g, map_of(g, [&](const Vec3d& p) { return gaussian(p, 0.31, -0.22, sigma); }), {}, estimate);
  ASSERT_TRUE(estimate.position);
  EXPECT_NEAR(estimate.position->x, 0.31, 0.03);
  EXPECT_NEAR(estimate.position->y, -0.22, 0.03);
  EXPECT_NEAR(std::sqrt(estimate.covariance[0]), sigma, 0.01);
  EXPECT_NEAR(std::sqrt(estimate.covariance[4]), sigma, 0.01);
  EXPECT_NEAR(estimate.accuracy_m, sigma * std::sqrt(-2.0 * std::log(0.05)), 0.03);
  EXPECT_FALSE(estimate.ambiguous);
}

TEST(Posterior, TemperWidens) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) { return gaussian(p, 0.0, 0.0, 0.15); });
  LocationEstimate sharp;
  LocationEstimate wide;
  summarise_posterior(g, map, {1.0, 0.95, 5}, sharp);
  summarise_posterior(g, map, {0.25, 0.95, 5}, wide);
  EXPECT_NEAR(wide.accuracy_m / sharp.accuracy_m, 2.0, 0.15);
}

TEST(Posterior, RegionExponentWidensAboutTheSamePosition) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) {
    return std::max(gaussian(p, 0.2, 0.1, 0.1), gaussian(p, -0.9, -0.6, 0.1) - 1.0);
  });
  LocationEstimate sharp;
  LocationEstimate wide;
  PosteriorOptions options;
  summarise_posterior(g, map, options, sharp);
  options.region_exponent = 0.25;
  summarise_posterior(g, map, options, wide);
  EXPECT_EQ(*wide.position, *sharp.position);
  EXPECT_GT(wide.accuracy_m, sharp.accuracy_m);
  EXPECT_GT(wide.covariance[0], sharp.covariance[0]);
  EXPECT_LT(wide.hypotheses[0].weight, sharp.hypotheses[0].weight);
}

TEST(Posterior, ReservesTheErrorProbabilityOfTheMap) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) { return gaussian(p, 0.0, 0.0, 0.08); });
  LocationEstimate sure;
  LocationEstimate suspect;
  summarise_posterior(g, map, {1.0, 0.95, 5, 0.0}, sure);
  summarise_posterior(g, map, {1.0, 0.95, 5, 0.03}, suspect);
  EXPECT_NEAR(suspect.residual_probability - sure.residual_probability, 0.03, 1e-3);
  EXPECT_NEAR(suspect.hypotheses[0].weight, 0.97 * sure.hypotheses[0].weight, 1e-9);
  EXPECT_EQ(*suspect.position, *sure.position);
  EXPECT_GT(suspect.accuracy_m, 1.05 * sure.accuracy_m);
}

// Four fifths are at one place; to hold 95 % of all a radius needs three quarters of the rest.
TEST(Posterior, WidensTheRadiusForALargeResidual) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) { return gaussian(p, 0.0, 0.0, 0.08); });
  LocationEstimate lost;
  summarise_posterior(g, map, {1.0, 0.95, 5, 0.2}, lost);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const Vec3d off = g.centre(i) - *lost.position;
    inside += std::hypot(off.x, off.y) <= lost.accuracy_m ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(g.size()), 0.77, 0.03);
}

TEST(Posterior, UsesTheMomentsWithinACell) {
  const Grid g = grid();
  std::vector<double> map(g.size(), -100.0);
  const std::size_t cell = 1000;
  map[cell] = 0.0;
  const CellMoments moments{0.012, -0.017, 4e-6, 0.0, 1e-6};
  const RefinedCells within{{cell, {moments, moments, 1.0}}};
  LocationEstimate estimate;
  summarise_posterior(g, map, {}, estimate, within);
  ASSERT_TRUE(estimate.position);
  EXPECT_NEAR(estimate.position->x, g.centre(cell).x + 0.012, 1e-9);
  EXPECT_NEAR(estimate.position->y, g.centre(cell).y - 0.017, 1e-9);
  // The uncertainty that the survey leaves is added.
  EXPECT_NEAR(estimate.covariance[0] - estimate.covariance[4], 3e-6, 1e-9);
}

// Nine tenths of a cell's mass are within millimetres, the rest somewhere in the cell.
TEST(Posterior, HasTheCoreAndTheTailOfAPeak) {
  const Grid g = grid();
  std::vector<double> map(g.size(), -100.0);
  const std::size_t cell = 1000;
  map[cell] = 0.0;
  const CellMoments uniform = uniform_moments(g);
  const CellMoments best{0.01, 0.0, 9e-6, 0.0, 9e-6};
  CellMoments all{0.009, 0.0, 0.0, 0.0, 0.9 * best.yy + 0.1 * uniform.yy};
  all.xx = 0.9 * (best.xx + best.x * best.x) + 0.1 * uniform.xx - all.x * all.x;
  const RefinedCells within{{cell, {all, best, 0.9}}};
  PosteriorOptions options;
  options.sigma_floor = 0.001;
  LocationEstimate estimate;
  summarise_posterior(g, map, options, estimate, within);
  ASSERT_EQ(estimate.hypotheses.size(), 2U);
  const Hypothesis& core = estimate.hypotheses[0];
  const Hypothesis& foot = estimate.hypotheses[1];
  // The part of the foot that is within the core may belong to either.
  EXPECT_NEAR(core.weight, 0.9, 0.02);
  EXPECT_NEAR(core.position.x, g.centre(cell).x + 0.01, 1e-4);
  EXPECT_NEAR(core.covariance[0], 1e-5, 1e-7);
  EXPECT_NEAR(core.weight + foot.weight, 1.0, 1e-9);
  EXPECT_NEAR(foot.covariance[0], uniform.xx + 1e-6, 2e-5);
  EXPECT_FALSE(estimate.ambiguous);  // both are of one place
  EXPECT_NEAR(estimate.residual_probability, 0.0, 1e-9);

  options.max_hypotheses = 1;
  LocationEstimate one;
  summarise_posterior(g, map, options, one, within);
  ASSERT_EQ(one.hypotheses.size(), 1U);
  EXPECT_NEAR(one.hypotheses[0].covariance[0], all.xx + 1e-6, 1e-9);
}

TEST(Posterior, StatesBothOfTwoPlacesAndThatItIsAmbiguous) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) {
    return std::log(2.0 * std::exp(gaussian(p, -1.0, 0.5, 0.06)) +
                    std::exp(gaussian(p, 1.0, -0.5, 0.06)) + 1e-30);
  });
  LocationEstimate estimate;
  summarise_posterior(g, map, {}, estimate);
  ASSERT_EQ(estimate.hypotheses.size(), 2U);
  EXPECT_NEAR(estimate.hypotheses[0].weight, 2.0 / 3.0, 0.01);
  EXPECT_NEAR(estimate.hypotheses[1].weight, 1.0 / 3.0, 0.01);
  EXPECT_NEAR(estimate.hypotheses[1].position.x, 1.0, 0.02);
  EXPECT_NEAR(estimate.position->x, -1.0, 0.02);
  EXPECT_TRUE(estimate.ambiguous);
  EXPECT_GT(estimate.accuracy_m, 2.0);  // 95 % of the mass are not in one place
}

// A hypothesis reaches 0.3 m: a broader hill is stated in pieces, which are one place.
TEST(Posterior, IsNotAmbiguousForABroadHill) {
  const Grid g = grid();
  const auto ridge = [&](double gap) {
    const auto map = map_of(g, [&](const Vec3d& p) {
      return std::abs(p.x) < gap ? -60.0 : -p.x * p.x / 0.5 - p.y * p.y / 0.005;
    });
    LocationEstimate estimate;
    summarise_posterior(g, map, {}, estimate);
    return estimate;
  };
  const LocationEstimate broad = ridge(0.0);
  ASSERT_GE(broad.hypotheses.size(), 3U);
  EXPECT_GT(broad.hypotheses[1].weight, 0.3 * broad.hypotheses[0].weight);
  EXPECT_FALSE(broad.ambiguous);
  EXPECT_TRUE(ridge(0.4).ambiguous);
}

TEST(Posterior, PrefersABroadPeakToASpike) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) {
    return std::log(3.0 * std::exp(gaussian(p, -1.0, 0.5, 0.01)) +
                    std::exp(gaussian(p, 1.0, -0.5, 0.1)) + 1e-30);
  });
  LocationEstimate estimate;
  summarise_posterior(g, map, {}, estimate);
  EXPECT_NEAR(estimate.position->x, 1.0, 0.05);
}

// The heaviest hill has two fifths, the others are side by side.
TEST(Posterior, IsNearHalfOfTheMass) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) {
    return std::log(4.0 * std::exp(gaussian(p, -1.0, 0.5, 0.05)) +
                    3.1 * std::exp(gaussian(p, 1.0, -0.5, 0.05)) +
                    2.9 * std::exp(gaussian(p, 1.0, -0.1, 0.05)) + 1e-30);
  });
  LocationEstimate estimate;
  summarise_posterior(g, map, {}, estimate);
  EXPECT_NEAR(estimate.position->x, 1.0, 0.03);
  EXPECT_NEAR(estimate.position->y, -0.5, 0.03);
  EXPECT_NEAR(estimate.hypotheses[0].position.x, -1.0, 0.03);
}

TEST(SmallestHalfMassDisc, HoldsHalfAndIsTheSmallest) {
  const Grid g = grid();
  std::vector<double> mass(g.size());
  const auto put = [&](std::size_t x, std::size_t y, double m) { mass[x * g.count_y + y] = m; };
  // 0.3 m apart, and 1 m away.
  put(10, 10, 0.3);
  put(16, 10, 0.25);
  put(40, 50, 0.45);
  const Disc disc = smallest_half_mass_disc(g, mass, 0.05);
  EXPECT_TRUE(disc.contains(g.centre(10 * g.count_y + 10)));
  EXPECT_TRUE(disc.contains(g.centre(16 * g.count_y + 10)));
  EXPECT_GE(disc.radius, 0.15);
  EXPECT_LE(disc.radius, 0.15 * 1.2 + g.step_x);
  // No smaller than was asked for; and at the edge of the grid.
  std::vector<double> corner(g.size());
  corner.back() = 1.0;
  EXPECT_EQ(smallest_half_mass_disc(g, corner, 0.12).radius, 0.12);
  EXPECT_TRUE(smallest_half_mass_disc(g, corner, 0.12).contains(g.centre(g.size() - 1)));
}

// A region of most of the room is correct: its accuracy states its size.
TEST(Posterior, AWideMapGivesAPositionIfItIsWanted) {
  const Grid g = grid();
  const auto map = map_of(g, [](const Vec3d& p) { return p.x > 0.0 ? 0.0 : -1.0; });
  LocationEstimate refused;
  summarise_posterior(g, map, {}, refused);
  EXPECT_FALSE(refused.position);
  LocationEstimate wide;
  summarise_posterior(g, map, {.max_spread = 0.95}, wide);
  ASSERT_TRUE(wide.position);
  EXPECT_GT(wide.position->x, 0.0);
  const double side = std::sqrt(static_cast<double>(g.size()) * g.step_x * g.step_y);
  EXPECT_GT(wide.accuracy_m, 0.5 * side);
  EXPECT_GT(wide.residual_probability, 0.5);
  LocationEstimate flat;
  summarise_posterior(g, std::vector<double>(g.size(), -7.0), {.max_spread = 0.95}, flat);
  EXPECT_FALSE(flat.position);
}

TEST(Posterior, AFlatMapGivesNoPosition) {
  const Grid g = grid();
  LocationEstimate estimate;
  summarise_posterior(g, std::vector<double>(g.size(), -7.0), {}, estimate);
  EXPECT_FALSE(estimate.position);
  EXPECT_NE(estimate.reason.find("flat"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::posterior_test
