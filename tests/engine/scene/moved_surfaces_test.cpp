#include "engine/scene/moved_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "engine/base/mat3.h"
#include "tests/support/scenes.h"

namespace rayloc::moved_surfaces_test {
namespace {

// Every face ends at its requested place, and the box stays closed.
TEST(MovedSurfaces, FacesOfARotatedBoxMoveByTheirOffsets) {
  Mesh box = test::box_mesh({-0.4, -0.3, -0.2}, {0.4, 0.3, 0.2});
  const Mat3d turn = rotation_from_yaw_pitch_roll(0.7, 0.2, -0.4);
  for (Vec3d& v : box.vertices) {
    v = Vec3d{1.0, 2.0, 0.5} + turn * v;
  }
  const auto scene = test::make_scene({{"box", box}}, test::kConcrete);
  ASSERT_EQ(scene->surfaces().size(), 6U);
  const std::vector<double> offset{0.01, -0.02, 0.03, 0.0, -0.015, 0.005};
  const auto moved = move_surfaces(*scene, offset);
  ASSERT_TRUE(moved) << moved.error().message;
  ASSERT_EQ(moved->surfaces().size(), 6U);
  for (std::size_t s = 0; s < 6; ++s) {
    const Plane<double>& before = scene->surfaces()[s].plane();
    // Areas change, and with them the order of the faces.
    double nearest = 1.0;
    for (const Surface& surface : moved->surfaces()) {
      if (dot(surface.plane().normal, before.normal) > 0.999) {
        nearest = std::abs(surface.plane().offset - before.offset - offset[s]);
      }
    }
    EXPECT_LT(nearest, 1e-12) << s;
  }
  EXPECT_EQ(moved->solid(0).shells, 1);
}

TEST(MovedSurfaces, NoOffsetChangesNothing) {
  const auto scene =
      test::make_scene({{"room", test::box_mesh({-2, -2, 0}, {2, 2, 3})}}, test::kConcrete);
  const auto moved = move_surfaces(*scene, std::vector<double>(scene->surfaces().size(), 0.0));
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->objects()[0].mesh.vertices, scene->objects()[0].mesh.vertices);
}

}  // namespace
}  // namespace rayloc::moved_surfaces_test
