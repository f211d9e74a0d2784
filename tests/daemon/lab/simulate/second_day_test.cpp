#include "daemon/lab/simulate/second_day.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/lab/simulate/capture_simulator.h"
#include "daemon/lab/simulate/rotations.h"
#include "engine/base/constants.h"
#include "engine/scene/bounds.h"
#include "engine/scene/scene.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/box_scene.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::second_day_test {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

// The synthetic room with a table, a chair of two parts, a crate, a tall cupboard, and a panel on
// the wall that is as small as a chair.
RoomModel furnished_room() {
  RoomModel room = test::make_room();
  room.scene = test::scene_of_boxes({{"west", "concrete", {-1.6, -1.2, 0}, {-1.5, 1.2, 2.5}},
                                     {"east", "concrete", {1.5, -1.2, 0}, {1.6, 1.2, 2.5}},
                                     {"south", "concrete", {-1.5, -1.3, 0}, {1.5, -1.2, 2.5}},
                                     {"north", "concrete", {-1.5, 1.2, 0}, {1.5, 1.3, 2.5}},
                                     {"floor", "concrete", {-1.5, -1.2, -0.1}, {1.5, 1.2, 0}},
                                     {"table", "wood", {0.3, 0.1, 0.7}, {1.4, 0.8, 0.75}},
                                     {"seat", "wood", {-0.5, 0.2, 0.42}, {-0.1, 0.6, 0.46}},
                                     {"back", "wood", {-0.5, 0.2, 0.46}, {-0.46, 0.6, 0.9}},
                                     {"crate", "metal", {-1.0, -0.9, 0}, {-0.6, -0.5, 0.5}},
                                     {"cupboard", "metal", {0.9, -1.15, 0}, {1.4, -0.8, 1.9}},
                                     {"panel", "wood", {0.2, -1.2, 0.3}, {0.6, -1.16, 0.6}}});
  return room;
}

LivedInRoom lived(const SecondDay& day, std::uint64_t seed = 1) {
  auto room = live_in(furnished_room(), day, seed);
  EXPECT_TRUE(room) << room.error().message;
  return *std::move(room);
}

SecondDay day_with(double SecondDay::*member, double value) {
  SecondDay day = unchanged_day();
  day.*member = value;
  return day;
}

TEST(SecondDay, WithoutChangesIsTheFirst) {
  const RoomModel room = furnished_room();
  const auto same = live_in(room, unchanged_day(), 1);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->room.scene, room.scene);
  EXPECT_TRUE(same->moved.empty());
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    EXPECT_TRUE(same->access_points[i].chain_changes.empty());
    EXPECT_EQ(same->room.access_points[i].array.pose.position,
              room.access_points[i].array.pose.position);
    EXPECT_EQ(same->room.access_points[i].array.pose.orientation.yaw,
              room.access_points[i].array.pose.orientation.yaw);
  }
}

// Each chain is rotated as a whole: its ripple over the band stays, and so does all else.
TEST(SecondDay, APowerCycleChangesOnlyChains) {
  const RoomModel room = furnished_room();
  SecondDay day = day_with(&SecondDay::chain_phase_deg, 180.0);
  day.chain_gain_db = 1.5;
  const LivedInRoom cycled = lived(day);
  EXPECT_EQ(cycled.room.access_points[1].array.pose.position,
            room.access_points[1].array.pose.position);
  EXPECT_TRUE(cycled.moved.empty());
  CaptureOptions options;
  options.impairments = default_impairments();
  options.impairments.calibrated_chains = false;
  const ChainGains before = CaptureSimulator(room, 1, options).chains();
  options.chain_changes = cycled.access_points[1].chain_changes;
  const ChainGains after = CaptureSimulator(cycled.room, 1, options).chains();
  ASSERT_EQ(options.chain_changes.size(), 3U);
  ASSERT_EQ(after.gain.size(), before.gain.size());
  const std::size_t tones = before.grid.size();
  for (std::size_t i = 0; i < before.gain.size(); ++i) {
    const auto wanted = before.gain[i] * options.chain_changes[i / tones];
    EXPECT_NEAR(std::abs(after.gain[i] - wanted), 0.0, 1e-12);
  }
  EXPECT_GT(std::abs(std::arg(options.chain_changes[1] / options.chain_changes[0])), 0.01);
}

TEST(SecondDay, ChainPhasesAreUniformAndGainsHaveTheirDeviation) {
  SecondDay day = day_with(&SecondDay::chain_phase_deg, 180.0);
  day.chain_gain_db = 1.5;
  std::complex<double> sum;
  double squares = 0.0;
  constexpr int kDays = 300;
  constexpr int kChains = 9 * kDays;
  for (int i = 0; i < kDays; ++i) {
    day.day = 2 + i;
    for (const BumpedAccessPoint& ap : lived(day).access_points) {
      for (const auto& factor : ap.chain_changes) {
        sum += factor / std::abs(factor);
        squares += std::pow(20.0 * std::log10(std::abs(factor)), 2);
      }
    }
  }
  EXPECT_LT(std::abs(sum) / kChains, 3.0 / std::sqrt(2.0 * kChains) + 0.01);
  EXPECT_NEAR(std::sqrt(squares / kChains), 1.5, 3 * 1.5 / std::sqrt(2.0 * kChains));
}

TEST(SecondDay, AccessPointsAreMovedAndRotatedByTheStatedAmount) {
  const RoomModel room = furnished_room();
  SecondDay day = day_with(&SecondDay::access_point_moved_m, 0.002);
  day.access_point_turned_deg = 0.3;
  const LivedInRoom bumped = lived(day);
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    const Pose& before = room.access_points[i].array.pose;
    const Pose& after = bumped.room.access_points[i].array.pose;
    EXPECT_NEAR(norm(after.position - before.position), 0.002, 1e-12);
    EXPECT_LT(norm(after.position - before.position - bumped.access_points[i].moved), 1e-12);
    // The trace of the rotation between the two is 1 + 2 cos(angle).
    const Mat3d a = rotation(before.orientation);
    const Mat3d b = rotation(after.orientation);
    const double trace = dot(a.row0, b.row0) + dot(a.row1, b.row1) + dot(a.row2, b.row2);
    EXPECT_NEAR(std::acos(0.5 * (trace - 1.0)) / kDegree, 0.3, 1e-5);
    EXPECT_NEAR(
        after.orientation.yaw - before.orientation.yaw, bumped.access_points[i].rotated.yaw, 1e-12);
    EXPECT_TRUE(bumped.access_points[i].chain_changes.empty());
  }
  EXPECT_NE(bumped.access_points[0].moved, bumped.access_points[1].moved);
}

std::map<std::string, Bounds> bounds_in(const RoomModel& room) {
  std::map<std::string, Bounds> bounds;
  for (const SceneObject& object : room.scene->objects()) {
    bounds[object.name] = bounds_of(object.mesh);
  }
  return bounds;
}

bool overlap(const Bounds& a, const Bounds& b) {
  constexpr double kTouch = 2e-3;  // [m]
  return a.lower.x + kTouch < b.upper.x && b.lower.x + kTouch < a.upper.x &&
         a.lower.y + kTouch < b.upper.y && b.lower.y + kTouch < a.upper.y &&
         a.lower.z + kTouch < b.upper.z && b.lower.z + kTouch < a.upper.z;
}

TEST(SecondDay, ChairsAndBoxesAreMovedAlongTheFloorToWhereTheyMeetNothing) {
  const SecondDay day = day_with(&SecondDay::moved_things, 5);
  const auto before = bounds_in(furnished_room());
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const LivedInRoom room = lived(day, seed);
    ASSERT_EQ(room.moved.size(), 2U) << "table, cupboard and panel stay";
    const auto after = bounds_in(room.room);
    std::set<std::string> moved;
    for (const MovedThing& thing : room.moved) {
      EXPECT_GE(norm(thing.by), 0.2);
      EXPECT_LE(norm(thing.by), 0.6);
      EXPECT_EQ(thing.by.z, 0.0);
      for (const std::string& name : thing.objects) {
        moved.insert(name);
        EXPECT_LT(norm(after.at(name).lower - before.at(name).lower - thing.by), 1e-6);
        EXPECT_GE(after.at(name).lower.x, -1.5);
        EXPECT_LE(after.at(name).upper.y, 1.2);
        for (const auto& [other, bounds] : after) {
          EXPECT_FALSE(other != name && overlap(after.at(name), bounds)) << name << " " << other;
        }
      }
    }
    EXPECT_THAT(moved, UnorderedElementsAre("seat", "back", "crate"));
    for (const char* stays : {"table", "cupboard", "panel", "north"}) {
      EXPECT_EQ(after.at(stays).lower, before.at(stays).lower);
    }
  }
}

TEST(SecondDay, MovesAsManyThingsAsAreAskedFor) {
  std::set<std::string> first;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const LivedInRoom room = lived(day_with(&SecondDay::moved_things, 1), seed);
    ASSERT_EQ(room.moved.size(), 1U);
    first.insert(room.moved[0].objects.front());
  }
  EXPECT_EQ(first, (std::set<std::string>{"crate", "seat"})) << "any of them may be the one";
}

// Lengths of the paths by the surface that they meet; by line of sight under -1.
std::map<int, double> lengths(const RoomModel& room) {
  TraceOptions options;
  options.max_depth = 1;
  const Transmitter device{{{-1.2, -0.4, 1.2}, {}, AntennaPattern::kHalfWaveDipole}};
  const Receiver antenna = array_origin<Receiver>(room.access_points[2].array);
  std::map<int, double> by_surface;
  for (const Path& path : PathTracer(room.scene, options).trace(device, antenna)) {
    const int surface =
        path.interactions.empty() ? -1 : static_cast<int>(path.interactions.front().surface);
    by_surface[surface] = kSpeedOfLight * path.tau;
  }
  return by_surface;
}

TEST(SecondDay, MovedFurnitureChangesThePathsThatMeetIt) {
  const RoomModel room = furnished_room();
  const auto before = lengths(room);
  ASSERT_TRUE(before.contains(-1));
  int changed = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const LivedInRoom later = lived(day_with(&SecondDay::moved_things, 5), seed);
    const auto after = lengths(later.room);
    EXPECT_EQ(after.at(-1), before.at(-1));
    std::set<int> surfaces;
    for (const auto& paths : {before, after}) {
      for (const auto& [surface, length] : paths) {
        surfaces.insert(surface);
      }
    }
    for (const int surface : surfaces) {
      const bool in_both = before.contains(surface) && after.contains(surface);
      const bool same = in_both && before.at(surface) == after.at(surface);
      const std::string name =
          surface < 0
              ? ""
              : room.scene->objects()[room.scene->owner(static_cast<std::uint32_t>(surface)).object]
                    .name;
      const bool movable = name == "seat" || name == "back" || name == "crate";
      changed += movable && !same ? 1 : 0;
      EXPECT_TRUE(same || movable || !in_both) << name << ": a path off what stays";
    }
  }
  EXPECT_GT(changed, 5);
}

TEST(SecondDay, DependsOnSeedAndDay) {
  SecondDay day = default_second_day();
  const LivedInRoom one = lived(day, 1);
  const LivedInRoom again = lived(day, 1);
  const LivedInRoom other = lived(day, 2);
  day.day = 3;
  const LivedInRoom third = lived(day, 1);
  EXPECT_EQ(one.moved.front().by, again.moved.front().by);
  EXPECT_EQ(one.access_points[2].chain_changes, again.access_points[2].chain_changes);
  for (const LivedInRoom* different : {&other, &third}) {
    EXPECT_NE(one.access_points[2].chain_changes, different->access_points[2].chain_changes);
    EXPECT_NE(one.access_points[2].moved, different->access_points[2].moved);
    EXPECT_NE(one.moved.front().by, different->moved.front().by);
  }
}

TEST(SecondDayFile, OverridesTheValuesOfItsBase) {
  const auto cycle = parse_second_day("base = \"none\"\nchain_phase_deg = 180\n", "day.toml");
  ASSERT_TRUE(cycle) << cycle.error().message;
  EXPECT_EQ(cycle->chain_phase_deg, 180.0);
  EXPECT_EQ(cycle->chain_gain_db, 0.0);
  EXPECT_EQ(cycle->moved_things, 0.0);
  EXPECT_EQ(cycle->access_point_moved_m, 0.0);
  const auto usual = parse_second_day("day = 7\n", "day.toml");
  ASSERT_TRUE(usual);
  EXPECT_EQ(usual->day, 7.0);
  EXPECT_EQ(usual->moved_things, default_second_day().moved_things);
}

TEST(SecondDayFile, RefusesInvalidDays) {
  const auto error = [](const char* text) {
    const auto day = parse_second_day(text, "day.toml");
    return day ? std::string("none") : day.error().message;
  };
  EXPECT_THAT(error("moved_thngs = 2\n"), HasSubstr("day.toml:1:1: unknown key 'moved_thngs'"));
  EXPECT_THAT(error("moved_things = 1.5\n"), HasSubstr("must be a whole number"));
  EXPECT_THAT(error("day = 1\n"), HasSubstr("day.toml:1:"));
  EXPECT_THAT(error("moved_least_m = 0.9\n"), HasSubstr("exchange them"));
  EXPECT_THAT(error("access_point_moved_m = 2\n"), HasSubstr("access_point_moved_m"));
  EXPECT_THAT(error("chain_gain_db = -1\n"), HasSubstr("chain_gain_db"));
}

TEST(SecondDayFile, HelpNamesEveryKey) {
  for (const SecondDayKey& key : second_day_keys()) {
    EXPECT_THAT(second_day_help(), HasSubstr(std::string(key.key) + " = "));
  }
}

}  // namespace
}  // namespace rayloc::second_day_test
