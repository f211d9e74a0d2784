#include "engine/scene/ray_shooter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "engine/base/mat3.h"
#include "tests/support/scenes.h"

namespace rayloc::ray_shooter_test {
namespace {

struct Met {
  std::uint32_t surface = kNoSurface;
  double distance = std::numeric_limits<double>::infinity();
};

// Every surface in double; `outwards` [m]: how far outside of its edges a surface is still met.
std::vector<Met> met_by_hand(const Scene& scene,
                             const Vec3d& from,
                             const Vec3d& direction,
                             double outwards) {
  std::vector<Met> met;
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    const Surface& surface = scene.surfaces()[i];
    const double along = dot(surface.plane().normal, direction);
    const double t = -distance(surface.plane(), from) / along;
    if (along != 0.0 && t > 0.0 && surface.contains(from + t * direction, outwards)) {
      met.push_back({i, t});
    }
  }
  std::sort(
      met.begin(), met.end(), [](const Met& a, const Met& b) { return a.distance < b.distance; });
  return met;
}

// One ray a stream.
Met shot(const Scene& scene, const Vec3d& from, const Vec3d& direction) {
  const RayShooter& shooter = scene.shooter();
  const Vec3d origin = from - shooter.origin();
  RayStream stream;
  stream.size = 1;
  stream.origin_x[0] = static_cast<float>(origin.x);
  stream.origin_y[0] = static_cast<float>(origin.y);
  stream.origin_z[0] = static_cast<float>(origin.z);
  stream.direction_x[0] = static_cast<float>(direction.x);
  stream.direction_y[0] = static_cast<float>(direction.y);
  stream.direction_z[0] = static_cast<float>(direction.z);
  shooter.shoot(stream, 0.0F);
  if (stream.triangle[0] == RayShooter::kNoTriangle) {
    return {};
  }
  return {shooter.triangles()[stream.triangle[0]].surface, static_cast<double>(stream.distance[0])};
}

// A room with boxes in random poses, and a wall with a hole among them.
std::shared_ptr<const Scene> room(double offset) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<test::NamedMesh> meshes{{"room", test::box_mesh({-5, -4, -3}, {5, 4, 3})}};
  for (int i = 0; i < 20; ++i) {
    Mesh box = test::box_mesh({-0.4, -0.3, -0.2}, {0.4, 0.3, 0.2});
    const Mat3d turn =
        rotation_from_yaw_pitch_roll(3 * uniform(random), uniform(random), uniform(random));
    const Vec3d centre{4 * uniform(random), 3 * uniform(random), 2 * uniform(random)};
    for (Vec3d& v : box.vertices) {
      v = centre + turn * v;
    }
    meshes.push_back({"box", std::move(box)});
  }
  Mesh wall = test::rectangle_mesh({-1, -1, -3}, {0, 2, 0}, {0, 0, 2});
  const Mesh above = test::rectangle_mesh({-1, -1, 1}, {0, 2, 0}, {0, 0, 1});
  wall.vertices.insert(wall.vertices.end(), above.vertices.begin(), above.vertices.end());
  wall.triangles.push_back({4, 5, 6});
  wall.triangles.push_back({4, 6, 7});
  meshes.push_back({"wall", std::move(wall)});
  for (test::NamedMesh& named : meshes) {
    for (Vec3d& v : named.mesh.vertices) {
      v.x += offset;
    }
  }
  return test::make_scene(meshes, test::kConcrete);
}

// offset [m]: also far from the origin, where floats are coarse.
class RayShooterAgrees : public ::testing::TestWithParam<double> {};

TEST_P(RayShooterAgrees, WithATestOfEverySurface) {
  const auto scene = room(GetParam());
  std::mt19937 random(22);
  std::normal_distribution<double> normal;
  const Vec3d from{GetParam() + 0.3, 0.2, 0.1};
  int unclear = 0;
  constexpr int kRays = 20'000;
  for (int i = 0; i < kRays; ++i) {
    const Vec3d direction = normalized(Vec3d{normal(random), normal(random), normal(random)});
    const auto hits = met_by_hand(*scene, from, direction, 0.0);
    ASSERT_FALSE(hits.empty());
    const Met found = shot(*scene, from, direction);
    const auto nearby = met_by_hand(*scene, from, direction, 1e-5);
    if (nearby.size() != hits.size() || found.surface != hits[0].surface) {
      ++unclear;  // within rounding of an edge
      EXPECT_TRUE(std::any_of(nearby.begin(), nearby.end(), [&](const Met& met) {
        return met.surface == found.surface;
      }));
      continue;
    }
    EXPECT_NEAR(found.distance, hits[0].distance, 1e-4);
  }
  EXPECT_LT(unclear, kRays / 1000);
}

// A ray at a vertex or an edge meets one of the surfaces there, not what lies behind.
TEST_P(RayShooterAgrees, OnVerticesAndEdges) {
  const auto scene = room(GetParam());
  const Vec3d from{GetParam() + 0.3, 0.2, 0.1};
  int aimed = 0;
  int through = 0;
  for (const SceneObject& object : scene->objects()) {
    for (const auto& t : object.mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d a = object.mesh.vertices[t[i]];
        const Vec3d b = object.mesh.vertices[t[(i + 1) % 3]];
        for (const Vec3d& aim : {a, 0.5 * (a + b), 0.9 * a + 0.1 * b}) {
          const Vec3d direction = normalized(aim - from);
          const Met found = shot(*scene, from, direction);
          const auto nearby = met_by_hand(*scene, from, direction, 1e-5);
          const auto same = std::find_if(nearby.begin(), nearby.end(), [&](const Met& met) {
            return met.surface == found.surface;
          });
          ASSERT_NE(same, nearby.end());
          EXPECT_NEAR(found.distance, same->distance, 1e-4);
          // A surface that is met a little inside of its edges is not passed.
          const auto certain = met_by_hand(*scene, from, direction, -1e-4);
          if (!certain.empty()) {
            EXPECT_LE(found.distance, certain[0].distance + 1e-4);
          }
          ++aimed;
          through += found.distance > nearby[0].distance + 1e-3 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(aimed, 1000);
  // Edges seen from outside: half of a ray's neighbours pass.
  EXPECT_LT(through, aimed / 2);
}

INSTANTIATE_TEST_SUITE_P(NearAndFar, RayShooterAgrees, ::testing::Values(0.0, 10'000.0));

TEST(RayShooter, ShootsStreamsOfAnySize) {
  const auto scene = room(0.0);
  const RayShooter& shooter = scene->shooter();
  for (const std::size_t size : {std::size_t{1}, std::size_t{7}, RayStream::kCapacity}) {
    RayStream stream;
    stream.size = size;
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::vector<Vec3d> directions;
    for (std::size_t i = 0; i < size; ++i) {
      directions.push_back(normalized(Vec3d{normal(random), normal(random), normal(random)}));
      stream.origin_x[i] = stream.origin_y[i] = stream.origin_z[i] = 0.25F;
      stream.direction_x[i] = static_cast<float>(directions[i].x);
      stream.direction_y[i] = static_cast<float>(directions[i].y);
      stream.direction_z[i] = static_cast<float>(directions[i].z);
    }
    shooter.shoot(stream, 0.0F);
    for (std::size_t i = 0; i < size; ++i) {
      const Met alone = shot(*scene, shooter.origin() + Vec3d{0.25, 0.25, 0.25}, directions[i]);
      ASSERT_NE(stream.triangle[i], RayShooter::kNoTriangle);
      EXPECT_EQ(shooter.triangles()[stream.triangle[i]].surface, alone.surface);
    }
  }
}

TEST(RayShooter, MissesAbsentSurfaces) {
  const auto scene = test::make_scene(
      {{"sheet", test::rectangle_mesh({1, -1, -1}, {0, 2, 0}, {0, 0, 2})}}, test::kConcrete);
  EXPECT_EQ(shot(*scene, {0, 0, 0}, {1, 0, 0}).surface, 0U);
  EXPECT_EQ(shot(*scene, {0, 0, 0}, {-1, 0, 0}).surface, kNoSurface);
  EXPECT_EQ(shot(*scene, {0, 0, 0}, normalized(Vec3d{1, 2, 0})).surface, kNoSurface);
}

}  // namespace
}  // namespace rayloc::ray_shooter_test
