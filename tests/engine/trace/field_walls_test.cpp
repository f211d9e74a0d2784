// Paths do not depend on how a room is rotated, nor into how many triangles its walls are cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/constants.h"
#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/rotated_walls.h"
#include "tests/support/scenes.h"

namespace rayloc::field_walls_test {
namespace {

using Scenery = std::vector<test::NamedMesh>;

// Every path of `before` is in `after`, and as many are in both.
void expect_same_paths(const Paths& before, const Paths& after, const std::string& what) {
  ASSERT_EQ(before.size(), after.size()) << what;
  for (const Path& path : before) {
    double nearest = 1.0;
    for (const Path& other : after) {
      if (std::abs(path.tau - other.tau) < 1e-18 &&
          path.interactions.size() == other.interactions.size()) {
        nearest = std::min(nearest, std::hypot(path.a.re - other.a.re, path.a.im - other.a.im));
      }
    }
    EXPECT_LE(nearest, 1e-13) << what << ", delay " << path.tau;
  }
}

// A closed room with objects in random poses.
Scenery random_scenery(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const Vec3d size{3.0 + 4.0 * share(random), 3.0 + 3.0 * share(random), 2.4 + share(random)};
  Scenery scenery{{"shell", test::box_mesh({0, 0, 0}, size)}};
  for (int i = 0; i < 3; ++i) {
    const Vec3d half{0.1 + 0.3 * share(random), 0.1 + 0.3 * share(random), 0.1 + share(random)};
    test::RigidMotion place = test::random_motion(random, 0.0);
    place.shift = {share(random) * size.x, share(random) * size.y, share(random) * size.z};
    scenery.push_back({"thing " + std::to_string(i), place(test::box_mesh(-half, half))});
  }
  return scenery;
}

Scenery changed(Scenery scenery, const test::RigidMotion& motion, std::uint32_t parts) {
  for (test::NamedMesh& named : scenery) {
    named.mesh = motion(test::subdivided(named.mesh, parts));
  }
  return scenery;
}

struct Link {
  Vec3d from;
  Vec3d to;
};

Paths trace(const Scenery& scenery,
            const TraceOptions& options,
            const Link& link,
            const test::RigidMotion& motion,
            const Orientation& turn) {
  return PathTracer(test::make_scene(scenery, test::kConcrete), options)
      .trace(Transmitter{{motion(link.from), turn}}, Receiver{{motion(link.to), turn}});
}

TEST(Field, RigidMotionAndSubdivisionLeaveAllPathsOfRandomScenes) {
  std::mt19937_64 random(19);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::size_t paths = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Scenery scenery = random_scenery(random);
    const Vec3d& size = scenery[0].mesh.vertices[7];
    const auto place = [&] {
      return Vec3d{size.x * share(random), size.y * share(random), size.z * share(random)};
    };
    const Link link{place(), place()};
    const TraceOptions options{.max_depth = 2, .transmission = trial % 4 == 3};
    const test::RigidMotion still{};
    const Paths before = trace(scenery, options, link, still, {});
    paths += before.size();
    const Orientation turn{6.0 * share(random), 3.0 * share(random) - 1.5, 6.0 * share(random)};
    const test::RigidMotion motion{rotation(turn), {40.0 * share(random), -30.0, 12.0}};
    for (const std::uint32_t parts : {1U, 10U}) {  // 2 and 200 triangles a wall
      const Paths after = trace(changed(scenery, motion, parts), options, link, motion, turn);
      expect_same_paths(
          before,
          after,
          "scene " + std::to_string(trial) + ", each triangle as " + std::to_string(parts * parts));
    }
  }
  EXPECT_GT(paths, 200U);
}

// 80 km away a double is known to 15 pm: nothing for a tolerance, something for a length.
TEST(Field, PathsFarFromTheOriginAreThoseAtIt) {
  std::mt19937_64 random(80);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int trial = 0; trial < 10; ++trial) {
    const Scenery scenery = random_scenery(random);
    const Vec3d& size = scenery[0].mesh.vertices[7];
    const auto place = [&] {
      return Vec3d{size.x * share(random), size.y * share(random), size.z * share(random)};
    };
    const Link link{place(), place()};
    const TraceOptions options{.max_depth = 2, .transmission = trial % 2 == 1};
    const Paths before = trace(scenery, options, link, {}, {});
    const Orientation turn{6.0 * share(random), 0.3, -0.2};
    const test::RigidMotion motion{rotation(turn), {80'000.0, -60'000.0, 500.0}};
    const Paths after = trace(changed(scenery, motion, 4), options, link, motion, turn);
    ASSERT_EQ(before.size(), after.size()) << trial;
    std::vector<double> delays;
    std::vector<double> far_delays;
    for (std::size_t i = 0; i < before.size(); ++i) {
      delays.push_back(before[i].tau);
      far_delays.push_back(after[i].tau);
    }
    std::sort(delays.begin(), delays.end());
    std::sort(far_delays.begin(), far_delays.end());
    for (std::size_t i = 0; i < delays.size(); ++i) {
      EXPECT_NEAR(delays[i] * kSpeedOfLight, far_delays[i] * kSpeedOfLight, 1e-8) << trial;
    }
  }
}

// Vertices that a file of floats has rounded.
TEST(Field, SubdivisionLeavesThePathsOfARoomOfFloats) {
  std::mt19937_64 random(81);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const auto rounded = [](Scenery scenery) {
    for (test::NamedMesh& named : scenery) {
      named.mesh = test::rounded_to_float(std::move(named.mesh));
    }
    return scenery;
  };
  for (int trial = 0; trial < 10; ++trial) {
    const Scenery scenery = random_scenery(random);
    const Vec3d& size = scenery[0].mesh.vertices[7];
    const auto place = [&] {
      return Vec3d{size.x * share(random), size.y * share(random), size.z * share(random)};
    };
    const Link link{place(), place()};
    const TraceOptions options{.max_depth = 2, .transmission = trial % 2 == 1};
    const Orientation turn{6.0 * share(random), 0.3, -0.2};
    const test::RigidMotion motion{rotation(turn), {200.0, -150.0, 20.0}};
    const Paths exact = trace(changed(scenery, motion, 1), options, link, motion, turn);
    for (const std::uint32_t parts : {1U, 10U}) {
      const Paths paths =
          trace(rounded(changed(scenery, motion, parts)), options, link, motion, turn);
      ASSERT_EQ(exact.size(), paths.size()) << trial << ", " << parts;
      for (std::size_t i = 0; i < paths.size(); ++i) {
        EXPECT_NEAR(exact[i].tau * kSpeedOfLight, paths[i].tau * kSpeedOfLight, 2e-3) << trial;
      }
    }
  }
}

TEST(Field, RotatedSubdividedWallReflectsUpToItsCorners) {
  std::mt19937_64 random(250);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3d size{1.0 + 4.0 * share(random), 1.0 + 2.0 * share(random), 0.0};
    const auto parts = 2 + static_cast<std::uint32_t>(trial) % 9;
    const test::RigidMotion motion = test::random_motion(random, 20.0);
    const Mesh wall = test::rectangle_mesh({0, 0, 0}, {size.x, 0, 0}, {0, size.y, 0});
    const auto scene =
        test::make_scene({{"wall", motion(test::subdivided(wall, parts))}}, test::kConcrete);
    const PathTracer tracer(scene, {.max_depth = 1});
    for (const double x : {0.001, 0.999, -0.001, 1.001}) {
      for (const double y : {0.001, 0.999, 1.001}) {
        const Vec3d at{x * size.x, y * size.y, 0.0};
        const Vec3d away{0.7 * share(random), share(random), 0.5 + share(random)};
        const Vec3d back{-away.x, -away.y, away.z};
        const Paths paths = tracer.trace({{motion(at + away), {}}}, {{motion(at + back), {}}});
        const bool is_on_wall = x > 0.0 && x < 1.0 && y < 1.0;
        ASSERT_EQ(paths.size(), is_on_wall ? 2U : 1U) << trial << ", at " << x << ", " << y;
        if (is_on_wall) {
          ASSERT_NEAR(paths[1].tau * kSpeedOfLight, 2.0 * norm(away), 1e-11) << trial;
        }
      }
    }
  }
}

// A sheet of 2 x 2 quads rotated about a diagonal in its plane, of which a quarter was lost.
TEST(Field, CornerOfASheetInARotateElementReflects) {
  const std::string xml =
      "<scene version='2.1.0'>"
      "<bsdf type='radio-material' id='mat-m'><float name='relative_permittivity' value='5.0'/>"
      "<float name='conductivity' value='0.05'/><float name='thickness' value='0.1'/></bsdf>"
      "<shape type='ply' id='mesh-w'><string name='filename' value='w.ply'/>"
      "<transform name='to_world'><rotate x='0.7071067811865475' y='0.7071067811865475' z='0.0' "
      "angle='91.0'/></transform><ref id='mat-m' name='bsdf'/></shape></scene>";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
      "property float z\nelement face 8\nproperty list uchar int vertex_indices\nend_header\n"
      "-2.0 -1.5 0.0\n0.0 -1.5 0.0\n2.0 -1.5 0.0\n-2.0 0.0 0.0\n0.0 0.0 0.0\n2.0 0.0 0.0\n"
      "-2.0 1.5 0.0\n0.0 1.5 0.0\n2.0 1.5 0.0\n"
      "3 0 1 4\n3 0 4 3\n3 1 2 5\n3 1 5 4\n3 3 4 7\n3 3 7 6\n3 4 5 8\n3 4 8 7\n";
  auto scene = parse_scene(
      xml, "scene.xml", {5e9, {}}, [&](const std::string&) { return Expected<std::string>(ply); });
  ASSERT_TRUE(scene) << scene.error().message;
  const Paths paths =
      PathTracer(std::make_shared<const Scene>(std::move(*scene)), {.max_depth = 1})
          .trace({{{0.04004516825079918, -1.3810838460922241, 0.27142101526260376}, {}}},
                 {{{-0.0003378862456884235, -2.84070086479187, 0.4660683274269104}, {}}});
  ASSERT_EQ(paths.size(), 2U);
  // By an exact reference in another program.
  EXPECT_NEAR(paths[1].tau, 1.0637504895491601e-08, 1e-20);
  EXPECT_NEAR(paths[1].a.re, -0.0007522492418825896, 1e-15);
  EXPECT_NEAR(paths[1].a.im, -0.00012592089399766148, 1e-15);
}

}  // namespace
}  // namespace rayloc::field_walls_test
