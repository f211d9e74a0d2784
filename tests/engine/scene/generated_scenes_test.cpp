// The generated rooms have the properties that the benchmarks state.
#include <gtest/gtest.h>

#include "engine/scene/scene.h"
#include "tests/support/laboratory.h"
#include "tests/support/office_floor.h"

namespace rayloc::generated_scenes_test {
namespace {

TEST(Laboratory, IsARoomOf23Boxes) {
  const auto scene = test::laboratory();
  EXPECT_EQ(scene->objects().size(), 23U);
  EXPECT_EQ(scene->triangle_count(), 276U);
  EXPECT_EQ(scene->dropped_triangles(), 0U);
  EXPECT_GE(scene->materials().size(), 5U);
  constexpr double kWalls = 0.4;  // [m], both
  const Vec3d size = scene->bounds_max() - scene->bounds_min();
  EXPECT_NEAR(size.x, 10.8 + kWalls, 1e-12);
  EXPECT_NEAR(size.y, 5.6 + kWalls, 1e-12);
  EXPECT_NEAR(size.z, 3.0 + kWalls, 1e-12);
}

TEST(Laboratory, PlacesAreOutsideTheFurniture) {
  const auto scene = test::laboratory();
  const auto positions = test::laboratory_positions(143);
  ASSERT_EQ(positions.size(), 143U);
  for (const Vec3d& position : positions) {
    for (const SceneObject& object : scene->objects()) {
      EXPECT_NEAR(winding_number(object.mesh, position), 0.0, 1e-9) << object.name;
    }
  }
}

TEST(OfficeFloor, HasTheTrianglesThatItWasAskedFor) {
  for (const std::size_t triangles : {100U, 1000U, 10'000U, 100'000U}) {
    const auto scene = test::office_floor(triangles);
    EXPECT_LE(scene->triangle_count(), triangles);
    EXPECT_GT(scene->triangle_count(), triangles - 12);
    for (const Vec3d& place :
         {test::office_access_point(), test::office_device(), test::office_corridor()}) {
      for (std::size_t i = 0; i < 30 && i < scene->objects().size(); ++i) {
        EXPECT_NEAR(winding_number(scene->objects()[i].mesh, place), 0.0, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace rayloc::generated_scenes_test
