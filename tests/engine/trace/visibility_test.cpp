// Soft visibility: the channel of a device on a walk has no jumps, and hard visibility is its
// limit.
#include "engine/trace/visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <vector>

#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::visibility_test {
namespace {

// Largest change of the carrier's channel, and of the channel's largest value, in `steps` steps.
struct Walk {
  double largest_step = 0.0;
  double largest_value = 0.0;
};

Walk walk(const std::shared_ptr<const Scene>& scene,
          const TraceOptions& options,
          const Vec3d& from,
          const Vec3d& to,
          const Vec3d& access_point,
          int steps) {
  const ReceiverTracer tracer = PathTracer(scene, options).at(Receiver{{access_point, {}}});
  const OfdmGrid grid{scene->carrier_hz(), 312'500.0, {0}};
  Walk result;
  std::complex<double> before;
  for (int i = 0; i <= steps; ++i) {
    const Vec3d at = from + (static_cast<double>(i) / steps) * (to - from);
    const std::complex<double> h = tracer.trace(Transmitter{{at, {}}}).cfr(grid)[0];
    if (i > 0) {
      result.largest_step = std::max(result.largest_step, std::abs(h - before));
    }
    result.largest_value = std::max(result.largest_value, std::abs(h));
    before = h;
  }
  return result;
}

std::shared_ptr<const Scene> screen() {
  return test::make_scene({{"screen", test::rectangle_mesh({-1, 0, 0}, {1, 0, 0}, {0, 0, 2})}},
                          test::kConcrete);
}

TEST(Visibility, SoftChannelIsContinuousAcrossAShadowEdge) {
  const auto scene = screen();
  const Vec3d from{-0.4, 2.0, 1.0};  // behind the screen
  const Vec3d to{0.4, 2.0, 1.0};     // in sight, and no reflection on this side
  const Vec3d access_point{0.0, -2.0, 1.0};
  const TraceOptions soft{.max_depth = 1, .softness = 0.05};
  const Walk coarse = walk(scene, soft, from, to, access_point, 500);
  const Walk fine = walk(scene, soft, from, to, access_point, 5000);
  EXPECT_LT(fine.largest_step, 0.15 * coarse.largest_step);
  // The edge of a hard shadow is a jump, whatever the step.
  const Walk hard = walk(scene, {.max_depth = 1}, from, to, access_point, 5000);
  EXPECT_GT(hard.largest_step, 0.9 * hard.largest_value);
}

TEST(Visibility, SoftChannelIsContinuousWhereAReflectionSlidesOffItsMirror) {
  const auto scene = screen();
  const Vec3d from{-1.6, -2.0, 1.0};
  const Vec3d to{1.6, -2.0, 1.0};
  const Vec3d access_point{0.3, -1.0, 1.2};
  const TraceOptions soft{.max_depth = 1, .softness = 0.05};
  const Walk coarse = walk(scene, soft, from, to, access_point, 1000);
  const Walk fine = walk(scene, soft, from, to, access_point, 10'000);
  EXPECT_LT(fine.largest_step, 0.15 * coarse.largest_step);
}

// A walk past furniture, over its edges and along walls, with everything that comes and goes.
TEST(Visibility, SoftChannelIsContinuousThroughAFurnishedRoom) {
  auto loaded = load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto scene = std::make_shared<const Scene>(std::move(*loaded));
  const Vec3d from{-1.3, -1.1, 1.1};
  const Vec3d to{1.2, 1.0, 1.2};
  const Vec3d access_point{-1.45, 1.13, 2.25};
  for (const bool transmission : {false, true}) {
    const TraceOptions soft{.max_depth = 2, .transmission = transmission, .softness = 0.05};
    const Walk coarse = walk(scene, soft, from, to, access_point, 1500);
    const Walk fine = walk(scene, soft, from, to, access_point, 6000);
    EXPECT_LT(fine.largest_step, 0.35 * coarse.largest_step) << transmission;
    const Walk hard =
        walk(scene, {.max_depth = 2, .transmission = transmission}, from, to, access_point, 6000);
    EXPECT_GT(hard.largest_step, 2.0 * fine.largest_step);  // the test is sensitive
  }
}

TEST(Visibility, HardVisibilityIsTheLimitOfSoft) {
  auto loaded = load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto scene = std::make_shared<const Scene>(std::move(*loaded));
  const Transmitter device{{{0.412, 1.037, 1.519}, {}}};
  const Receiver access_point{{{-1.45, 1.13, 2.25}, {}}};
  for (const bool transmission : {false, true}) {
    const TraceOptions hard{.max_depth = 3, .transmission = transmission};
    TraceOptions soft = hard;
    soft.softness = 1e-6;
    const Paths expected = PathTracer(scene, hard).trace(device, access_point);
    const Paths paths = PathTracer(scene, soft).trace(device, access_point);
    ASSERT_EQ(paths.size(), expected.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
      EXPECT_NEAR(paths[i].a.re, expected[i].a.re, 1e-15);
      EXPECT_NEAR(paths[i].a.im, expected[i].a.im, 1e-15);
      EXPECT_NEAR(paths[i].tau, expected[i].tau, 1e-20);
    }
  }
}

TEST(Visibility, StepIsSmoothAndSymmetric) {
  EXPECT_EQ(smooth_step(-0.1), 0.0);
  EXPECT_EQ(smooth_step(0.0), 0.0);
  EXPECT_EQ(smooth_step(1.0), 1.0);
  EXPECT_EQ(smooth_step(1.1), 1.0);
  EXPECT_DOUBLE_EQ(smooth_step(0.5), 0.5);
  for (const double x : {0.1, 0.3, 0.45}) {
    EXPECT_NEAR(smooth_step(x) + smooth_step(1.0 - x), 1.0, 1e-14);
  }
}

// An L of two rectangles, and the distance from its boundary.
TEST(Visibility, NonConvexSurfaceUsesItsBoundary) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  const auto surfaces = planar_surfaces(mesh);
  ASSERT_EQ(surfaces.size(), 1U);
  const Surface& surface = surfaces[0].surface;
  ASSERT_FALSE(surface.is_convex());
  const auto inside = [&](const Vec3d& point) {
    const Vec3d from = point - surface.origin();
    return surface.inside_distance(dot(surface.u_axis(), from), dot(surface.v_axis(), from));
  };
  EXPECT_NEAR(inside({0.5, 0.5, 0}), 0.5, 1e-12);  // on an inner side of a triangle
  EXPECT_NEAR(inside({0.9, 0.9, 0}), std::hypot(0.1, 0.1), 1e-12);
  EXPECT_NEAR(inside({1.5, 0.9, 0}), 0.1, 1e-12);
  EXPECT_NEAR(inside({1.5, 1.25, 0}), -0.25, 1e-12);
  EXPECT_NEAR(inside({2.3, 1.4, 0}), -0.5, 1e-12);
}

// A path that keeps clear of all edges does not depend on the softness.
TEST(Visibility, MiddleOfAMirrorReflectsAllOfIt) {
  const auto scene = screen();
  const Transmitter device{{{-0.2, -1.0, 1.0}, {}}};
  const Receiver access_point{{{-0.7, -0.8, 0.8}, {}}};
  const Paths hard = PathTracer(scene, {.max_depth = 1}).trace(device, access_point);
  const Paths soft =
      PathTracer(scene, {.max_depth = 1, .softness = 0.05}).trace(device, access_point);
  ASSERT_EQ(hard.size(), 2U);
  ASSERT_EQ(soft.size(), 2U);
  EXPECT_NEAR(soft[1].a.re, hard[1].a.re, 1e-17);
  EXPECT_EQ(soft[1].interactions[0].weight, 1.0);
}

}  // namespace
}  // namespace rayloc::visibility_test
