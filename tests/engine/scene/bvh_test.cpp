#include "engine/scene/bvh.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "engine/base/mat3.h"
#include "tests/support/scenes.h"

namespace rayloc::bvh_test {
namespace {

// The rule of bvh.h written down again, over every surface.
bool blocked_by_hand(const Scene& scene, const Segment& s) {
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    const Surface& surface = scene.surfaces()[i];
    const double from = distance(surface.plane(), s.from);
    const double to = distance(surface.plane(), s.to);
    if (i == s.from_surface || i == s.to_surface || (from > 0.0) == (to > 0.0)) {
      continue;
    }
    const Vec3d point = s.from + (from / (from - to)) * (s.to - s.from);
    if (norm(point - s.from) > kEndTolerance && norm(point - s.to) > kEndTolerance &&
        surface.contains(point)) {
      return true;
    }
  }
  return false;
}

std::size_t crossings_by_hand(const Scene& scene, const Segment& s, double margin) {
  std::size_t count = 0;
  for (const Surface& surface : scene.surfaces()) {
    const double from = distance(surface.plane(), s.from);
    const double to = distance(surface.plane(), s.to);
    const Vec3d point = s.from + (from / (from - to)) * (s.to - s.from);
    if ((from > 0.0) != (to > 0.0) && surface.contains(point, margin)) {
      ++count;
    }
  }
  return count;
}

std::shared_ptr<const Scene> boxes(double offset) {
  std::vector<test::NamedMesh> meshes;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 40; ++i) {
    const Vec3d centre{offset + 4 * uniform(random), 4 * uniform(random), 2 * uniform(random)};
    Mesh box = test::box_mesh({-0.4, -0.3, -0.2}, {0.4, 0.3, 0.2});
    const Mat3d turn =
        rotation_from_yaw_pitch_roll(3 * uniform(random), uniform(random), uniform(random));
    for (Vec3d& v : box.vertices) {
      v = centre + turn * v;
    }
    meshes.push_back({"box", std::move(box)});
  }
  return test::make_scene(meshes, test::kConcrete);
}

// offset: also far from the origin, where floats are coarse.
class BvhAgrees : public ::testing::TestWithParam<double> {};

TEST_P(BvhAgrees, WithATestOfEverySurface) {
  const auto scene = boxes(GetParam());
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-5.0, 5.0);
  int blocked = 0;
  constexpr int kSegments = 20'000;
  for (int i = 0; i < kSegments; ++i) {
    const Vec3d from{GetParam() + uniform(random), uniform(random), uniform(random)};
    const Vec3d to{GetParam() + uniform(random), uniform(random), uniform(random)};
    const Segment segment{from, to};
    const bool expected = blocked_by_hand(*scene, segment);
    ASSERT_EQ(scene->is_blocked(segment), expected) << "seed 11, segment " << i;
    blocked += expected ? 1 : 0;
  }
  EXPECT_GT(blocked, kSegments / 10);
  EXPECT_LT(blocked, kSegments * 9 / 10);
}

// Every surface of a segment, once, in order; and those that it only just misses.
TEST_P(BvhAgrees, OnAllCrossings) {
  const auto scene = boxes(GetParam());
  constexpr double kMargin = 0.05;
  const auto wide = Bvh::create(scene->surfaces(), kMargin);
  ASSERT_TRUE(wide.has_value());
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(-5.0, 5.0);
  std::vector<Crossing> found;
  std::size_t more = 0;
  for (int i = 0; i < 2'000; ++i) {
    const Segment segment{{GetParam() + uniform(random), uniform(random), uniform(random)},
                          {GetParam() + uniform(random), uniform(random), uniform(random)}};
    scene->crossings(segment, found);
    EXPECT_EQ(!found.empty(), scene->is_blocked(segment));
    ASSERT_EQ(found.size(), crossings_by_hand(*scene, segment, 0.0)) << "seed 13, segment " << i;
    for (std::size_t j = 1; j < found.size(); ++j) {
      EXPECT_LT(found[j - 1].share, found[j].share);
    }
    const std::size_t hard = found.size();
    wide->crossings(segment, found);
    ASSERT_EQ(found.size(), crossings_by_hand(*scene, segment, kMargin)) << "segment " << i;
    more += found.size() - hard;
  }
  EXPECT_GT(more, 0U);
}

// Rays aimed at vertices, edges and seams, where single precision would be ambiguous.
TEST_P(BvhAgrees, OnVerticesAndEdges) {
  const auto scene = boxes(GetParam());
  const Vec3d eye{GetParam() + 0.1, 0.2, 6.0};
  for (const SceneObject& object : scene->objects()) {
    for (const auto& t : object.mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d a = object.mesh.vertices[t[i]];
        const Vec3d b = object.mesh.vertices[t[(i + 1) % 3]];
        for (const Vec3d& aim : {a, 0.5 * (a + b), 0.9 * a + 0.1 * b}) {
          const Segment beyond{eye, eye + 1.5 * (aim - eye)};
          EXPECT_EQ(scene->is_blocked(beyond), blocked_by_hand(*scene, beyond));
          const Segment inside_out{aim, eye};
          EXPECT_EQ(scene->is_blocked(inside_out), blocked_by_hand(*scene, inside_out));
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(NearAndFar, BvhAgrees, ::testing::Values(0.0, 1000.0));

std::shared_ptr<const Scene> wall() {
  return test::make_scene({{"wall", test::rectangle_mesh({0, -1, 0}, {0, 2, 0}, {0, 0, 2})}},
                          test::kConcrete);
}

TEST(Bvh, WallBlocksCrossingSegments) {
  const auto scene = wall();
  EXPECT_TRUE(scene->is_blocked({{-1, 0, 1}, {1, 0, 1}}));
  EXPECT_FALSE(scene->is_blocked({{-1, 0, 3}, {1, 0, 3}}));
  EXPECT_FALSE(scene->is_blocked({{-1, 0, 1}, {-0.1, 0, 1}}));
}

TEST(Bvh, SeamOfTwoTrianglesLetsNothingThrough) {
  const auto scene = wall();
  for (int i = 1; i < 100; ++i) {
    const double y = -1.0 + 0.02 * i;
    EXPECT_TRUE(scene->is_blocked({{-1, y, 0.02 * i}, {1, y, 0.02 * i}})) << i;
    EXPECT_TRUE(scene->is_blocked({{-1, 0.3, 0.7}, {1, 2 * y - 0.3, 0.04 * i - 0.7}})) << i;
  }
}

TEST(Bvh, PathAlongAWallIsNotLost) {
  const auto scene = wall();
  EXPECT_FALSE(scene->is_blocked({{0, -0.9, 1}, {0, 0.9, 1}}));          // within the plane
  EXPECT_FALSE(scene->is_blocked({{1e-12, -0.9, 1}, {1e-12, 0.9, 1}}));  // a hair above
}

TEST(Bvh, DeviceMountedOnAWallIsReachable) {
  const auto scene = wall();
  EXPECT_FALSE(scene->is_blocked({{0, 0, 1}, {2, 0.5, 1}}));
  EXPECT_FALSE(scene->is_blocked({{-2, 0, 1}, {1e-12, 0, 1}}));
}

TEST(Bvh, SurfaceThatIsTouchedDoesNotBlock) {
  const auto scene = wall();
  const Segment grazing{{1e-8, 0, 1}, {-1e-8, 0.9, 1}};
  EXPECT_TRUE(scene->is_blocked(grazing));
  EXPECT_FALSE(scene->is_blocked({grazing.from, grazing.to, 0, kNoSurface}));
  EXPECT_FALSE(scene->is_blocked({grazing.from, grazing.to, kNoSurface, 0}));
}

TEST(Bvh, VeryFarDevicesAreDecidedInDoubleToo) {
  const auto scene = wall();
  EXPECT_TRUE(scene->is_blocked({{-5e6, 0, 1}, {5e6, 0, 1}}));
  EXPECT_FALSE(scene->is_blocked({{-5e6, 0, 2.001}, {5e6, 0, 2.001}}));
}

}  // namespace
}  // namespace rayloc::bvh_test
