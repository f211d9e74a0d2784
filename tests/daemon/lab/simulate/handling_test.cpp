#include "daemon/lab/simulate/handling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/lab/simulate/capture_simulator.h"
#include "engine/base/constants.h"
#include "tests/support/box_scene.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::handling_test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr double kStepSeconds = 0.05;

// All at one place; of a walk at 20 frames a second.
std::vector<SimulatedPoint> test_points(int count, const Vec3d& place = {0.3, -0.4, 1.2}) {
  std::vector<SimulatedPoint> all;
  for (int i = 0; i < count; ++i) {
    all.push_back({i + 2, place, {{Timestamp(milliseconds(50 * i)), 0, 0}}});
  }
  return all;
}

std::vector<SimulatedPoint> handled(std::vector<SimulatedPoint> all,
                                    const Handling& handling,
                                    bool is_walk = false,
                                    std::uint64_t seed = 1) {
  const auto done = handle_devices(all, is_walk, handling, test::make_room(), seed, "p.csv");
  EXPECT_TRUE(done) << done.error().message;
  return all;
}

double tilt_of(const SimulatedPoint& test_point) {
  return std::acos((rotation(test_point.orientation) * Vec3d{0, 0, 1}).z) / kDegree;
}

double mean(const std::vector<SimulatedPoint>& all,
            const std::function<double(const SimulatedPoint&)>& value) {
  double sum = 0.0;
  for (const SimulatedPoint& test_point : all) {
    sum += value(test_point);
  }
  return sum / static_cast<double>(all.size());
}

TEST(Handling, HeightsAreNormalAboutThatOfTheDevice) {
  constexpr int kCount = 4000;
  const auto all = handled(test_points(kCount), {.height_sigma = 0.2});
  EXPECT_NEAR(mean(all, [](const auto& s) { return s.position.z; }), 1.2, 3 * 0.2 / 63);
  const auto square = [](const auto& s) { return std::pow(s.position.z - 1.2, 2); };
  EXPECT_NEAR(std::sqrt(mean(all, square)), 0.2, 0.008);
  // Two thirds of a normal distribution are within its deviation.
  EXPECT_NEAR(mean(all, [](const auto& s) { return std::abs(s.position.z - 1.2) < 0.2 ? 1 : 0; }),
              0.683,
              0.023);
  for (const SimulatedPoint& test_point : all) {
    EXPECT_EQ(test_point.position.x, 0.3);
    EXPECT_EQ(test_point.position.y, -0.4);
    EXPECT_EQ(test_point.orientation.pitch, 0.0);
    EXPECT_EQ(test_point.power_db, 0.0);
  }
}

TEST(Handling, HeightsStayInTheRoom) {
  for (const bool is_walk : {false, true}) {
    const auto all = handled(test_points(2000), {.height_sigma = 2.0}, is_walk);
    const auto [lowest, highest] =
        std::minmax_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
          return a.position.z < b.position.z;
        });
    EXPECT_GE(lowest->position.z, 0.1);
    EXPECT_LE(highest->position.z, 2.4);  // the ceiling is at 2.5 m
    EXPECT_LT(lowest->position.z, 0.3);
    EXPECT_GT(highest->position.z, 2.2);
  }
}

TEST(Handling, DevicesAreNotInsideOfFurniture) {
  RoomModel room = test::make_room();
  room.scene = test::scene_of_boxes({{"floor", "concrete", {-2, -2, -0.1}, {2, 2, 0}},
                                     {"desk", "wood", {0, -0.8, 0}, {0.6, 0, 1.1}}});
  auto all = test_points(300);
  ASSERT_TRUE(handle_devices(all, false, {.height_sigma = 0.3}, room, 1, "p.csv"));
  for (const SimulatedPoint& test_point : all) {
    EXPECT_GT(test_point.position.z, 1.1);
  }
  room.scene = test::scene_of_boxes({{"floor", "concrete", {-2, -2, -0.1}, {2, 2, 0}},
                                     {"pillar", "concrete", {0, -0.8, 0}, {0.6, 0, 2.5}}});
  all = test_points(2);
  EXPECT_THAT(handle_devices(all, false, {.height_sigma = 0.3}, room, 1, "p.csv").error().message,
              HasSubstr("p.csv: line 2: no height of 1.2"));
  room.device.height = 2.6;
  EXPECT_THAT(handle_devices(all, false, {.height_sigma = 0.3}, room, 1, "p.csv").error().message,
              HasSubstr("not inside of the room"));
}

TEST(Handling, TiltsAreUniformUpToTheMostAndToAllSides) {
  const auto all = handled(test_points(4000), {.tilt_deg = 35.0});
  EXPECT_NEAR(mean(all, tilt_of), 17.5, 3 * 10.1 / 63);
  EXPECT_NEAR(mean(all, [](const auto& s) { return tilt_of(s) < 8.75 ? 1 : 0; }), 0.25, 0.021);
  Vec3d sum;
  for (const SimulatedPoint& test_point : all) {
    ASSERT_LE(tilt_of(test_point), 35.0);
    sum = sum + rotation(test_point.orientation) * Vec3d{0, 0, 1};
    EXPECT_EQ(test_point.position.z, 1.2);
  }
  EXPECT_NEAR(std::hypot(sum.x, sum.y) / 4000, 0.0, 3 * 0.25 / 63);
}

TEST(Handling, PowersHaveTheStatedDeviation) {
  const auto all = handled(test_points(4000), {.power_sigma_db = 4.0});
  EXPECT_NEAR(mean(all, [](const auto& s) { return s.power_db; }), 0.0, 3 * 4.0 / 63);
  EXPECT_NEAR(
      std::sqrt(mean(all, [](const auto& s) { return s.power_db * s.power_db; })), 4.0, 0.15);
}

// A hand does not jump: 50 ms are a fortieth of the two seconds over which it moves.
TEST(Handling, AlongAWalkEverythingChangesSmoothly) {
  const Handling handling{0.3, 35.0, 4.0};
  const auto walk = handled(test_points(1200), handling, true);
  const auto apart = handled(test_points(1200), handling, false);
  const auto largest_step = [](const auto& all, const auto& value) {
    double largest = 0.0;
    for (std::size_t i = 1; i < all.size(); ++i) {
      largest = std::max(largest, std::abs(value(all[i]) - value(all[i - 1])));
    }
    return largest;
  };
  const auto height = [](const SimulatedPoint& s) { return s.position.z; };
  const auto power = [](const SimulatedPoint& s) { return s.power_db; };
  EXPECT_LT(largest_step(walk, height), 0.3 * 4 * kStepSeconds / 2.0);
  EXPECT_LT(largest_step(walk, power), 4.0 * 4 * kStepSeconds / 2.0);
  EXPECT_LT(largest_step(walk, tilt_of), 35.0 * 4 * kStepSeconds / 2.0);
  EXPECT_GT(largest_step(apart, height), 0.5);
  // And over many walks the spread is that of test points.
  double squares = 0.0;
  constexpr int kWalks = 800;
  for (int seed = 0; seed < kWalks; ++seed) {
    const auto brief =
        handled(test_points(1), {.height_sigma = 0.2}, true, static_cast<unsigned>(seed));
    squares += std::pow(brief[0].position.z - 1.2, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kWalks), 0.2, 3 * 0.2 / 40);
}

TEST(Handling, DependsOnTheSeedAndAPointMoreLeavesTheOthers) {
  const Handling handling{0.3, 35.0, 4.0};
  const auto all = handled(test_points(3), handling);
  const auto again = handled(test_points(4), handling);
  const auto other = handled(test_points(3), handling, false, 2);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(all[i].position, again[i].position);
    EXPECT_EQ(all[i].orientation.pitch, again[i].orientation.pitch);
    EXPECT_EQ(all[i].power_db, again[i].power_db);
    EXPECT_NE(all[i].position, other[i].position);
  }
  EXPECT_FALSE(Handling{}.changes_anything());
  EXPECT_EQ(handled(test_points(1), {})[0].position, test_points(1)[0].position);
}

// The recording contains the channel of a device at the test point's orientation and power.
TEST(Handling, ReachesTheChannel) {
  const RoomModel room = test::make_room();
  const auto tones = [&](const SimulatedPoint& test_point) {
    CaptureOptions options;
    options.impairments = no_impairments();
    const auto received = CaptureSimulator(room, 0, options).capture(test_point);
    std::vector<std::vector<std::byte>> payloads;
    for (const SimulatedDatagram& datagram : received->datagrams) {
      payloads.push_back(datagram.payload);
    }
    return payloads;
  };
  const SimulatedPoint upright = test_points(1)[0];
  SimulatedPoint leaning = upright;
  leaning.orientation.pitch = 0.5;
  SimulatedPoint rotated = upright;
  rotated.orientation.yaw = 0.5;  // a vertical dipole is the same all around
  SimulatedPoint loud = upright;
  loud.power_db = 6.0;
  EXPECT_EQ(tones(rotated), tones(upright));
  EXPECT_NE(tones(leaning), tones(upright));
  EXPECT_NE(tones(loud), tones(upright));
}

}  // namespace
}  // namespace rayloc::handling_test
