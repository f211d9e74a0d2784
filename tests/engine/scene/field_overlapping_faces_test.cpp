// Coplanar faces of one object that lie over each other: strips of a frame that cross at its
// corners, and both faces of a wall in one mesh.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "engine/scene/overlap/disjoint_triangles.h"
#include "engine/scene/surface.h"
#include "tests/support/rotated_walls.h"
#include "tests/support/scenes.h"

namespace rayloc::field_overlapping_faces_test {
namespace {

struct Rectangle {
  double left, bottom, right, top;
};

// Rectangles of the plane z = 0. `flipped`: facing down, cut along the other diagonal.
void append(const Rectangle& r, bool flipped, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(
      mesh.vertices.end(),
      {{r.left, r.bottom, 0}, {r.right, r.bottom, 0}, {r.right, r.top, 0}, {r.left, r.top, 0}});
  if (flipped) {
    mesh.triangles.push_back({first, first + 3, first + 1});
    mesh.triangles.push_back({first + 1, first + 3, first + 2});
  } else {
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
}

Mesh mesh_of(const std::vector<Rectangle>& rectangles, bool both_faces = false) {
  Mesh mesh;
  for (const Rectangle& r : rectangles) {
    append(r, false, mesh);
    if (both_faces) {
      append(r, true, mesh);
    }
  }
  return mesh;
}

// 4 x 2 m with an opening of `opening` m^2: strips that overlap by 4 w h = 2 m^2 at the corners.
const std::vector<Rectangle> kStrips{{0, 0, 4, 0.5}, {0, 1.5, 4, 2}, {0, 0, 1, 2}, {3, 0, 4, 2}};

// Checks strips like a wall with a hole: its open part, its covered part, and its outline.
void expect_frame(const Mesh& mesh, const test::RigidMotion& motion) {
  const auto found = planar_surfaces(motion(mesh));
  ASSERT_EQ(found.size(), 1U);
  const Surface& wall = found[0].surface;
  EXPECT_NEAR(wall.area(), 6.0, 1e-9);
  EXPECT_FALSE(wall.is_convex());
  const auto inside = [&](double x, double y) {
    const Vec3d from = motion({x, y, 0}) - wall.origin();
    return wall.inside_distance(dot(wall.u_axis(), from), dot(wall.v_axis(), from));
  };
  for (double x = 0.05; x < 4.0; x += 0.1) {
    for (double y = 0.05; y < 2.0; y += 0.1) {
      const bool is_open = x > 1 && x < 3 && y > 0.5 && y < 1.5;
      ASSERT_EQ(wall.contains(motion({x, y, 0})), !is_open) << x << ", " << y;
      const double to_outline = std::min({x, 4 - x, y, 2 - y});
      const double to_opening =
          std::hypot(std::max({1 - x, 0.0, x - 3}), std::max({0.5 - y, 0.0, y - 1.5}));
      const double within_opening = std::min({x - 1, 3 - x, y - 0.5, 1.5 - y});
      ASSERT_NEAR(inside(x, y), is_open ? -within_opening : std::min(to_outline, to_opening), 1e-9)
          << x << ", " << y;
    }
  }
}

// The origin is no special place, nor are the axes of the world.
std::vector<test::RigidMotion> motions() {
  std::mt19937_64 random(7);
  std::vector<test::RigidMotion> all(5);
  for (test::RigidMotion& motion : all) {
    motion = test::random_motion(random, 20.0);
  }
  return all;
}

TEST(Field, StripsThatCrossAtTheCornersLeaveTheWindowOpen) {
  for (const test::RigidMotion& motion : motions()) {
    expect_frame(mesh_of(kStrips), motion);
  }
}

TEST(Field, BothFacesOfAWallInOneMeshLeaveTheWindowOpen) {
  // Cut as carpenters do: pieces that meet. Their two faces have twice the area of one.
  const std::vector<Rectangle> pieces{
      {0, 0, 4, 0.5}, {0, 1.5, 4, 2}, {0, 0.5, 1, 1.5}, {3, 0.5, 4, 1.5}};
  for (const test::RigidMotion& motion : motions()) {
    expect_frame(mesh_of(pieces, true), motion);
    expect_frame(mesh_of(kStrips, true), motion);
  }
}

TEST(Field, BothFacesOfAWallThatIsHalfOpenLeaveItOpen) {
  // Twice the area of the wall is that of its outline.
  const double third = 1.0 / 3.0;
  const Mesh mesh = mesh_of({{0, 0, 4, third},
                             {0, 5 * third, 4, 2},
                             {0, third, 0.5, 5 * third},
                             {3.5, third, 4, 5 * third}},
                            true);
  const auto found = planar_surfaces(mesh);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].surface.area(), 4.0, 1e-9);
  EXPECT_FALSE(found[0].surface.contains({2, 1, 0}));
  EXPECT_TRUE(found[0].surface.contains({0.25, 1, 0}));
}

TEST(Field, BothFacesOfAWallAreOneSheet) {
  const auto found = planar_surfaces(mesh_of({{0, 0, 4, 2}}, true));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].surface.area(), 8.0, 1e-12);
  EXPECT_TRUE(found[0].surface.is_convex());
  EXPECT_FALSE(found[0].one_facing);
  EXPECT_EQ(classify_solid(mesh_of({{0, 0, 4, 2}}, true)).shells, 0);
}

TEST(Field, BoxDrawnFromBothSidesIsSixSheets) {
  for (const test::RigidMotion& motion : motions()) {
    Mesh box = test::box_mesh({0, 0, 0}, {4, 3, 2.5});
    const auto outer = box.triangles;
    for (const auto& [a, b, c] : outer) {
      box.triangles.push_back({a, c, b});
    }
    EXPECT_EQ(classify_solid(motion(box)).shells, 0);
    EXPECT_EQ(planar_surfaces(motion(box)).size(), 6U);
  }
  // A sheet of metal is a body.
  EXPECT_EQ(classify_solid(test::box_mesh({0, 0, 0}, {4, 3, 0.0005})).shells, 1);
}

TEST(Field, ParallelFacesOfAWallStayTwoSheets) {
  Mesh mesh = mesh_of(kStrips);
  Mesh back = mesh_of(kStrips);
  for (Vec3d& v : back.vertices) {
    v.z = 0.1;
  }
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), back.vertices.begin(), back.vertices.end());
  for (const auto& [a, b, c] : back.triangles) {
    mesh.triangles.push_back({first + a, first + c, first + b});
  }
  const auto found = planar_surfaces(mesh);
  ASSERT_EQ(found.size(), 2U);
  for (const MeshSurface& face : found) {
    EXPECT_NEAR(face.surface.area(), 6.0, 1e-9);
    EXPECT_FALSE(face.surface.contains({2, 1, face.surface.origin().z}));
  }
}

TEST(Field, OverlapsAreCountedOnceHoweverTrianglesLie) {
  // Against a count of points of a grid.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Triangle2> triangles(6);
    for (Triangle2& t : triangles) {
      for (Point2& corner : t) {
        corner = {place(random), place(random)};
      }
    }
    const auto covers = [](std::span<const Triangle2> all, const Point2& p) {
      int count = 0;
      for (const Triangle2& t : all) {
        const int a = orientation(t[0], t[1], p);
        const int b = orientation(t[1], t[2], p);
        const int c = orientation(t[2], t[0], p);
        count += a == b && b == c ? 1 : 0;
      }
      return count;
    };
    const auto parts = disjoint_triangles(triangles, 1e-10);
    for (double u = 0.0103; u < 1.0; u += 0.0517) {
      for (double v = 0.0071; v < 1.0; v += 0.0517) {
        ASSERT_EQ(covers(parts, {u, v}), std::min(1, covers(triangles, {u, v})))
            << trial << ": " << u << ", " << v;
      }
    }
  }
}

TEST(Field, TrianglesThatOnlyTouchStayAsTheyAre) {
  std::vector<Triangle2> triangles;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      const Point2 a{0.1 * i, 0.1 * j};
      const Point2 b{0.1 * (i + 1), 0.1 * j};
      const Point2 c{0.1 * (i + 1), 0.1 * (j + 1)};
      const Point2 d{0.1 * i, 0.1 * (j + 1)};
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  triangles.push_back({Point2{-1, 0}, Point2{0, 0}, Point2{0, 2}});  // with corners on its side
  EXPECT_EQ(disjoint_triangles(triangles, 1e-10), triangles);
}

}  // namespace
}  // namespace rayloc::field_overlapping_faces_test
