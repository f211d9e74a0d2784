#include "daemon/pipeline/zones/gaussian_in_polygon.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::gaussian_in_polygon_test {
namespace {

using Point = std::array<double, 2>;
using Polygon = std::vector<Point>;

double below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

Polygon box(double x0, double x1, double y0, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

TEST(GaussianInPolygon, MatchesErrorFunctionsForABox) {
  const PlanarGaussian gaussian{{0.3, -0.2}, 0.25, 0.0, 0.04};
  for (const double size : {0.05, 0.4, 1.0, 3.0, 40.0, 1e4}) {
    const double x = below((size - 0.3) / 0.5) - below((-size - 0.3) / 0.5);
    const double y = below((2 * size + 0.2) / 0.2) - below((-size / 2 + 0.2) / 0.2);
    EXPECT_NEAR(gaussian_in_polygon(gaussian, box(-size, size, -size / 2, 2 * size)), x * y, 1e-11)
        << size;
  }
}

TEST(GaussianInPolygon, MatchesSheppardForACorrelatedQuadrant) {
  for (const double rho : {-0.95, -0.3, 0.0, 0.5, 0.999}) {
    const PlanarGaussian gaussian{{1.0, 2.0}, 4.0, rho * 6.0, 9.0};
    EXPECT_NEAR(gaussian_in_polygon(gaussian, box(1.0, 1e3, 2.0, 1e3)),
                0.25 + std::asin(rho) / (2.0 * std::numbers::pi),
                1e-10)
        << rho;
  }
}

TEST(GaussianInPolygon, MatchesRayleighForACircle) {
  constexpr int kCorners = 20'000;
  for (const double radius : {0.5, 1.0, 2.5}) {
    Polygon circle;
    for (int i = 0; i < kCorners; ++i) {
      const double angle = -2.0 * std::numbers::pi * i / kCorners;  // clockwise
      circle.push_back({5.0 + radius * std::cos(angle), radius * std::sin(angle) - 7.0});
    }
    EXPECT_NEAR(gaussian_in_polygon({{5.0, -7.0}, 1.0, 0.0, 1.0}, circle),
                1.0 - std::exp(-0.5 * radius * radius),
                1e-7);
  }
}

// Even-odd rule on the corners as they are.
bool contains(const Polygon& polygon, const Point& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point& a = polygon[i];
    const Point& b = polygon[j];
    if ((a[1] > p[1]) != (b[1] > p[1]) &&
        p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]) {
      inside = !inside;
    }
  }
  return inside;
}

// Sum of the density over a fine raster of the polygon: nothing in common with the tested code.
double raster_sum(const PlanarGaussian& g, const Polygon& polygon) {
  constexpr int kSteps = 1'200;
  const double determinant = g.variance_x * g.variance_y - g.covariance_xy * g.covariance_xy;
  const double step_x = 12.0 * std::sqrt(g.variance_x) / kSteps;
  const double step_y = 12.0 * std::sqrt(g.variance_y) / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double dx = (i + 0.5 - 0.5 * kSteps) * step_x;
      const double dy = (j + 0.5 - 0.5 * kSteps) * step_y;
      if (contains(polygon, {g.mean[0] + dx, g.mean[1] + dy})) {
        sum += std::exp(
            -0.5 *
            (g.variance_y * dx * dx - 2.0 * g.covariance_xy * dx * dy + g.variance_x * dy * dy) /
            determinant);
      }
    }
  }
  return sum * step_x * step_y / (2.0 * std::numbers::pi * std::sqrt(determinant));
}

TEST(GaussianInPolygon, MatchesARasterSumForStars) {
  constexpr unsigned kSeed = 20261122;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int round = 0; round < 8; ++round) {
    Polygon star;
    const int corners = 3 + static_cast<int>(9.0 * uniform(random));
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / corners;
      const double radius = 0.1 + 2.0 * uniform(random);
      star.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    const double x = 0.1 + uniform(random);
    const double y = 0.1 + uniform(random);
    const PlanarGaussian gaussian{{2.0 * uniform(random) - 1.0, 2.0 * uniform(random) - 1.0},
                                  x * x,
                                  (1.8 * uniform(random) - 0.9) * x * y,
                                  y * y};
    EXPECT_NEAR(gaussian_in_polygon(gaussian, star), raster_sum(gaussian, star), 5e-4)
        << "round " << round << " of seed " << kSeed;
  }
}

TEST(GaussianInPolygon, TakesAKnownPlaceForOne) {
  const Polygon square = box(0.0, 1.0, 0.0, 1.0);
  EXPECT_NEAR(gaussian_in_polygon({{0.5, 0.5}, 0.0, 0.0, 0.0}, square), 1.0, 1e-12);
  EXPECT_NEAR(gaussian_in_polygon({{1.5, 0.5}, 0.0, 0.0, 0.0}, square), 0.0, 1e-12);
  // On a line: x = y.
  EXPECT_NEAR(gaussian_in_polygon({{0.0, 0.0}, 1.0, 1.0, 1.0}, square), below(1.0) - 0.5, 1e-3);
}

TEST(GaussianInPolygon, AddsUpOverAPartition) {
  const PlanarGaussian gaussian{{0.2, 0.1}, 0.3, -0.2, 0.5};
  const Polygon lower = {{-9, -9}, {9, -9}, {9, 0.3}, {-9, -0.7}};
  const Polygon upper = {{-9, -0.7}, {9, 0.3}, {9, 9}, {-9, 9}};
  EXPECT_NEAR(
      gaussian_in_polygon(gaussian, lower) + gaussian_in_polygon(gaussian, upper), 1.0, 1e-11);
}

}  // namespace
}  // namespace rayloc::gaussian_in_polygon_test
