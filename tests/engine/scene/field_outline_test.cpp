// Outlines of walls as files from the field have them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "engine/scene/convex_hull.h"
#include "engine/scene/surface.h"
#include "tests/support/rotated_walls.h"
#include "tests/support/scenes.h"

namespace rayloc::field_outline_test {
namespace {

double nearest(const std::vector<Vec3d>& corners, const Vec3d& point) {
  double least = 1e9;
  for (const Vec3d& corner : corners) {
    least = std::min(least, norm(corner - point));
  }
  return least;
}

// A wall of nu x nv quads, two triangles each, in any order.
Mesh grid_wall(double width, double height, std::uint32_t nu, std::uint32_t nv) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= nv; ++j) {
    for (std::uint32_t i = 0; i <= nu; ++i) {
      mesh.vertices.push_back({width * i / nu, height * j / nv, 0.0});
    }
  }
  for (std::uint32_t j = 0; j < nv; ++j) {
    for (std::uint32_t i = 0; i < nu; ++i) {
      const std::uint32_t a = j * (nu + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + nu + 2});
      mesh.triangles.push_back({a, a + nu + 2, a + nu + 1});
    }
  }
  return mesh;
}

TEST(Field, OutlineOfARotatedSubdividedWallKeepsItsFourCorners) {
  std::mt19937_64 random(25);
  std::uniform_int_distribution<std::uint32_t> parts(1, 7);
  std::uniform_real_distribution<double> side(0.2, 12.0);
  for (int trial = 0; trial < 10'000; ++trial) {
    const double width = side(random);
    const double height = side(random);
    Mesh mesh = grid_wall(width, height, parts(random), parts(random));
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    const test::RigidMotion motion = test::random_motion(random, 50.0);
    const auto surfaces = planar_surfaces(motion(mesh));
    ASSERT_EQ(surfaces.size(), 1U) << trial;
    const Surface& wall = surfaces[0].surface;
    ASSERT_EQ(wall.outline().size(), 4U) << trial;
    ASSERT_EQ(wall.pieces().size(), 1U) << trial;
    for (const Vec3d& corner :
         {Vec3d{}, Vec3d{width, 0, 0}, Vec3d{width, height, 0}, Vec3d{0, height, 0}}) {
      ASSERT_LE(nearest(wall.outline(), motion(corner)), 1e-12) << trial;
    }
    ASSERT_NEAR(wall.area(), width * height, 1e-10) << trial;
  }
}

TEST(Field, OutlineOfAFineCircleStaysACircle) {
  // Each corner alone is nearly on the line between its neighbours; all of them are not.
  std::vector<Point2> points;
  constexpr int kCorners = 4096;
  constexpr double kTolerance = 1e-5;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    points.push_back({std::cos(angle), std::sin(angle)});
  }
  const std::vector<Point2> hull = convex_hull(points, kTolerance);
  ASSERT_LT(hull.size(), points.size());
  for (const Point2& p : points) {
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Point2& a = hull[i];
      const Point2& b = hull[(i + 1) % hull.size()];
      const double inside = ((b.u - a.u) * (p.v - a.v) - (b.v - a.v) * (p.u - a.u)) /
                            std::hypot(b.u - a.u, b.v - a.v);
      ASSERT_GE(inside, -kTolerance * (1.0 + 1e-9));
    }
  }
}

TEST(Field, OrientationIsDecidedWithoutRounding) {
  // One unit in the last place off the diagonal, which products of doubles cannot resolve.
  const Point2 a{12.0, 12.0};
  const Point2 b{24.0, 24.0};
  const double next = std::nextafter(0.5, 1.0);
  EXPECT_EQ(orientation({0.5, 0.5}, a, b), 0);
  EXPECT_EQ(orientation({0.5, next}, a, b), 1);
  EXPECT_EQ(orientation({next, 0.5}, a, b), -1);
  EXPECT_EQ(orientation(a, b, {0.5, next}), 1);
  EXPECT_EQ(orientation(b, {next, 0.5}, a), -1);
}

}  // namespace
}  // namespace rayloc::field_outline_test
