#include "engine/trace/images/beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/trace/images/beam_shadow.h"

namespace rayloc::beam_test {
namespace {

constexpr double kMargin = 1e-6;

// In the plane x = `x`, from (y0, z0) to (y1, z1); anticlockwise seen from where x is larger.
Polygon rectangle(double x, double y0, double y1, double z0, double z1) {
  return {{x, y0, z0}, {x, y1, z0}, {x, y1, z1}, {x, y0, z1}};
}

Surface screen(double x, double y0, double y1) {
  const Polygon c = rectangle(x, y0, y1, -1, 1);
  return {{{1, 0, 0}, x}, {{c[0], c[1], c[2]}, {c[0], c[2], c[3]}}};
}

TEST(Clip, RemovesThePartBehindThePlane) {
  Polygon polygon = rectangle(0, 0, 4, 0, 1);
  Polygon scratch;
  clip({{0, 1, 0}, 1.0}, polygon, scratch);
  ASSERT_EQ(polygon.size(), 4U);
  for (const Vec3d& corner : polygon) {
    EXPECT_TRUE(std::abs(corner.y - (1.0 - kBeamMargin)) < 1e-12 || corner.y == 4.0);
  }
  clip({{0, 1, 0}, 5.0}, polygon, scratch);
  EXPECT_TRUE(polygon.empty());
}

TEST(Clip, LeavesAnInsidePolygonUnchanged) {
  const Polygon whole = rectangle(0, 0, 4, 0, 1);
  Polygon polygon = whole;
  Polygon scratch;
  clip({{0, 1, 0}, 0.0}, polygon, scratch);
  EXPECT_EQ(polygon, whole);
}

TEST(Grown, MovesEveryEdgeOutwards) {
  const Polygon polygon = grown(rectangle(0, 0, 4, 0, 1), {1, 0, 0}, 0.25);
  const Polygon expected = rectangle(0, -0.25, 4.25, -0.25, 1.25);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(norm(polygon[i] - expected[i]), 0.0, 1e-15);
  }
}

TEST(BeamPlanes, BoundTheViewOfTheApexThroughTheWindow) {
  const Polygon window = rectangle(2, -1, 1, -1, 1);
  for (const double side : {-1.0, 1.0}) {
    const Vec3d apex{2 + 2 * side, 0, 0};
    std::vector<Plane<double>> planes;
    beam_planes(std::vector{apex}, 2 * side, window, planes);
    ASSERT_EQ(planes.size(), 4U);
    const auto holds = [&](double y, double z) {
      const Vec3d point{2 - 2 * side, y, z};  // twice as far from the apex as the window
      return std::all_of(planes.begin(), planes.end(), [&](const Plane<double>& plane) {
        return distance(plane, point) >= 0.0;
      });
    };
    EXPECT_TRUE(holds(0.0, 0.0));
    EXPECT_TRUE(holds(1.99, -1.99));
    EXPECT_FALSE(holds(2.01, 0.0));
    EXPECT_FALSE(holds(0.0, -2.01));
  }
}

TEST(BeamPlanes, BoundTheViewsOfAllApexes) {
  const Polygon window = rectangle(2, -1, 1, -1, 1);
  const std::vector<Vec3d> apexes{{0, 0.3, 0}, {0.1, -0.2, 0.4}, {-0.2, 0, -0.1}};
  std::vector<Plane<double>> planes;
  beam_planes(apexes, -2.0, window, planes);
  ASSERT_EQ(planes.size(), 4U);
  for (const Vec3d& apex : apexes) {
    for (const Vec3d& corner : window) {
      for (const Plane<double>& plane : planes) {
        EXPECT_GE(distance(plane, corner + 3.0 * (corner - apex)), -1e-12);
      }
    }
  }
  // And no more: each plane touches the beam of one of them.
  for (const Plane<double>& plane : planes) {
    EXPECT_TRUE(std::any_of(apexes.begin(), apexes.end(), [&](const Vec3d& apex) {
      return std::abs(distance(plane, apex)) < 1e-12;
    }));
  }
}

// A window of no width still bounds: a beam must not become a half space.
TEST(BeamPlanes, BoundASliverFromBothSides) {
  std::vector<Plane<double>> planes;
  beam_planes(std::vector{Vec3d{}}, -2.0, rectangle(2, 0, 1e-7, -1, 1), planes);
  ASSERT_GE(planes.size(), 2U);
  for (const double y : {-0.1, 0.1}) {
    EXPECT_TRUE(std::any_of(planes.begin(), planes.end(), [&](const Plane<double>& plane) {
      return distance(plane, Vec3d{4, y, 0}) < -0.01;
    })) << y;
  }
}

TEST(BeamShadow, FallsOnAWindowThatIsWhollyBehind) {
  const BeamShadow shadow({0, 0, 0}, nullptr, kMargin);
  EXPECT_TRUE(shadow.hides(screen(1, -1, 1), rectangle(2, -1.9, 1.9, -1, 1)));
  EXPECT_FALSE(shadow.hides(screen(1, -1, 1), rectangle(2, -1.9, 2.1, -1, 1)));
  EXPECT_FALSE(shadow.hides(screen(2, -1, 1), rectangle(2, -0.5, 0.5, -1, 1)));  // in its plane
  EXPECT_FALSE(shadow.hides(screen(3, -1, 1), rectangle(2, -0.5, 0.5, -1, 1)));  // beyond it
  EXPECT_FALSE(shadow.hides(screen(-1, -1, 1), rectangle(2, -0.5, 0.5, -1, 1)));
}

TEST(BeamShadow, KeepsItsMarginToEdgesAndEnds) {
  const Vec3d apex{0, 0, 0};
  const Polygon window = rectangle(2, -1.8, 1.8, -0.5, 0.5);  // crosses x = 1 up to 0.9
  EXPECT_TRUE(BeamShadow(apex, nullptr, 0.09).hides(screen(1, -1, 1), window));
  EXPECT_FALSE(BeamShadow(apex, nullptr, 0.11).hides(screen(1, -1, 1), window));
  EXPECT_TRUE(BeamShadow(apex, nullptr, 0.05).hides(screen(1.94, -9, 9), window));
  EXPECT_FALSE(BeamShadow(apex, nullptr, 0.05).hides(screen(1.96, -9, 9), window));
  EXPECT_FALSE(BeamShadow(apex, nullptr, 0.05).hides(screen(0.04, -9, 9), window));
}

TEST(BeamShadow, BeginsAtTheMirror) {
  const Plane<double> mirror{{1, 0, 0}, 1.5};
  const BeamShadow shadow({0, 0, 0}, &mirror, kMargin);
  EXPECT_FALSE(shadow.hides(screen(1, -1, 1), rectangle(2, -0.5, 0.5, -1, 1)));
  EXPECT_TRUE(shadow.hides(screen(1.7, -1, 1), rectangle(2, -0.5, 0.5, -1, 1)));
}

}  // namespace
}  // namespace rayloc::beam_test
