// Links without any path: an empty result, from which everything follows without a special case.
#include <array>
#include <complex>
#include <vector>

#include <gtest/gtest.h>

#include "engine/trace/path_tracer.h"
#include "tests/support/scenes.h"

namespace rayloc::no_path_test {
namespace {

const RadioMaterial kMetal{"metal", 1.0, 1e7, 0.1};
const OfdmGrid kGrid{test::kCarrier, 312'500.0, {-2, -1, 0, 1, 2}};

// A room of 4 x 3 x 2.5 m with a block in the middle.
std::shared_ptr<const Scene> room(const RadioMaterial& material) {
  return test::make_scene({{"shell", test::box_mesh({0, 0, 0}, {4, 3, 2.5})},
                           {"block", test::box_mesh({1.5, 1, 0.5}, {2.5, 2, 1.5})}},
                          material);
}

void expect_silence(const std::shared_ptr<const Scene>& scene,
                    const TraceOptions& options,
                    const Vec3d& transmitter_at,
                    const Vec3d& receiver_at) {
  const Transmitter transmitter{{transmitter_at, {}}};
  const ReceiverTracer tracer = PathTracer(scene, options).at(Receiver{{receiver_at, {}}});
  const Paths paths = tracer.trace(transmitter);
  EXPECT_TRUE(paths.empty()) << paths.size() << " paths";
  EXPECT_EQ(paths.cfr(kGrid), std::vector<std::complex<double>>(kGrid.size()));
  const std::array parameters{Parameter::receiver_position(0), Parameter::thickness(0)};
  const auto derivatives = tracer.differentiate(transmitter, paths, parameters);
  ASSERT_TRUE(derivatives) << derivatives.error().message;
  const std::vector<std::complex<double>> adjoint(kGrid.size(), {1.0, 1.0});
  EXPECT_EQ(derivatives->loss_gradient(paths, kGrid, adjoint), (std::vector{0.0, 0.0}));
}

constexpr Vec3d kInTheRoom{0.53, 0.47, 1.1};
constexpr Vec3d kInTheBlock{2.13, 1.41, 1.05};
constexpr Vec3d kOutside{6.0, 1.5, 1.0};

TEST(NoPath, DeviceInsideAWallReceivesNothing) {
  expect_silence(room(test::kConcrete), {}, kInTheBlock, kInTheRoom);
  expect_silence(room(test::kConcrete), {}, kInTheRoom, kInTheBlock);
}

TEST(NoPath, ClosedRoomSendsNothingOutside) {
  expect_silence(room(test::kConcrete), {}, kInTheRoom, kOutside);
  expect_silence(room(test::kConcrete), {.max_depth = 0}, kInTheRoom, kOutside);
}

TEST(NoPath, MetalLetsNothingThrough) {
  const TraceOptions through{.max_depth = 3, .transmission = true};
  expect_silence(room(kMetal), through, kInTheRoom, kOutside);
  // The same walls of concrete do: straight through and with reflections before.
  EXPECT_FALSE(PathTracer(room(test::kConcrete), through)
                   .trace(Transmitter{{kInTheRoom, {}}}, Receiver{{kOutside, {}}})
                   .empty());
}

TEST(NoPath, SoftEdgesDoNotOpenAClosedRoom) {
  expect_silence(room(test::kConcrete), {.softness = 0.05}, kInTheRoom, kOutside);
}

}  // namespace
}  // namespace rayloc::no_path_test
