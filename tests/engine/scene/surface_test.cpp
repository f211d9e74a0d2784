#include "engine/scene/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/mat3.h"
#include "engine/scene/solid.h"
#include "tests/support/scenes.h"

namespace rayloc::surface_test {
namespace {

// A 3 x 3 m square without its middle square metre.
Mesh frame() {
  Mesh mesh;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      mesh.vertices.push_back({1.0 * x, 1.0 * y, 0.0});
    }
  }
  for (std::uint32_t y = 0; y < 3; ++y) {
    for (std::uint32_t x = 0; x < 3; ++x) {
      const std::uint32_t i = 4 * y + x;
      if (x != 1 || y != 1) {
        mesh.triangles.push_back({i, i + 1, i + 5});
        mesh.triangles.push_back({i, i + 5, i + 4});
      }
    }
  }
  return mesh;
}

TEST(Surface, BoxHasSixMirrors) {
  const auto surfaces = planar_surfaces(test::box_mesh({0, 0, 0}, {1, 2, 3}));
  ASSERT_EQ(surfaces.size(), 6U);
  for (const MeshSurface& face : surfaces) {
    EXPECT_TRUE(face.one_facing);
    EXPECT_EQ(face.surface.pieces().size(), 1U);
    EXPECT_EQ(face.surface.outline().size(), 4U);
    EXPECT_EQ(norm(face.surface.plane().normal), 1.0);
  }
}

TEST(Surface, RoundedCornersOfATiltedBoxStaySixMirrors) {
  Mesh mesh = test::box_mesh({-1, -2, -0.5}, {1, 2, 0.5});
  const Mat3d turn = rotation_from_yaw_pitch_roll(0.4, 0.2, -0.7);
  for (Vec3d& v : mesh.vertices) {
    v = turn * v + Vec3d{12.0, -7.0, 3.0};
    v = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  EXPECT_EQ(planar_surfaces(mesh).size(), 6U);
}

TEST(Surface, HoleIsNotPartOfIt) {
  const auto surfaces = planar_surfaces(frame());
  ASSERT_EQ(surfaces.size(), 1U);
  const Surface& surface = surfaces[0].surface;
  EXPECT_FALSE(surface.contains({1.5, 1.5, 0.0}));
  EXPECT_TRUE(surface.contains({0.5, 1.5, 0.0}));
  EXPECT_TRUE(surface.contains({2.5, 2.5, 0.0}));  // on a seam
  EXPECT_FALSE(surface.contains({3.1, 1.5, 0.0}));
  EXPECT_EQ(surface.outline().size(), 4U);
  EXPECT_NEAR(surface.area(), 8.0, 1e-12);
}

TEST(Surface, FineMeshIsOneConvexPiece) {
  Mesh mesh = frame();
  mesh.triangles.push_back({5, 6, 10});
  mesh.triangles.push_back({5, 10, 9});
  const auto surfaces = planar_surfaces(mesh);
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_EQ(surfaces[0].surface.pieces().size(), 1U);
}

TEST(Surface, BothFacesOfASheetAreOneMirror) {
  Mesh mesh = test::rectangle_mesh({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  mesh.triangles.push_back({0, 2, 1});
  mesh.triangles.push_back({0, 3, 2});
  const auto surfaces = planar_surfaces(mesh);
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_FALSE(surfaces[0].one_facing);
}

TEST(Surface, ParallelPlanesStayApart) {
  Mesh mesh = test::rectangle_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Mesh above = test::rectangle_mesh({0, 0, 1e-3}, {1, 0, 0}, {0, 1, 0});
  mesh.vertices.insert(mesh.vertices.end(), above.vertices.begin(), above.vertices.end());
  mesh.triangles.push_back({4, 5, 6});
  mesh.triangles.push_back({4, 6, 7});
  EXPECT_EQ(planar_surfaces(mesh).size(), 2U);
}

TEST(Solid, BoxIsClosedAndSeparatesInsideFromOutside) {
  const Mesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
  const Solid solid = classify_solid(box);
  EXPECT_EQ(solid.shells, 1);
  EXPECT_EQ(solid.orientation, 1);
  EXPECT_NEAR(winding_number(box, {0.5, 1.0, 0.1}), 1.0, 1e-12);
  EXPECT_NEAR(winding_number(box, {0.5, 1.0, 3.1}), 0.0, 1e-12);
  EXPECT_NEAR(winding_number(box, {0.5, 1.0, 3.0}), 0.5, 1e-12);
}

TEST(Solid, InsideOutBoxIsRecognised) {
  Mesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
  for (auto& triangle : box.triangles) {
    std::swap(triangle[0], triangle[1]);
  }
  EXPECT_EQ(classify_solid(box).orientation, -1);
}

TEST(Solid, OpenMeshHasNoInside) {
  Mesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
  box.triangles.pop_back();
  EXPECT_EQ(classify_solid(box).shells, 0);
}

TEST(Solid, OneReversedTriangleOpensIt) {
  Mesh box = test::box_mesh({0, 0, 0}, {1, 2, 3});
  std::swap(box.triangles[0][0], box.triangles[0][1]);
  EXPECT_EQ(classify_solid(box).shells, 0);
}

}  // namespace
}  // namespace rayloc::surface_test
