#include "engine/track/cloud_room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/support/cloud_scene.h"

namespace rayloc::cloud_room_test {
namespace {

std::size_t quarter(const Vec3d& at) { return (at.x > 0.0 ? 1U : 0U) + (at.y > 0.0 ? 2U : 0U); }

std::shared_ptr<const CloudRoom> open_room() {
  static const auto kRoom = test::cloud_room(test::make_room());
  return kRoom;
}

std::shared_ptr<const CloudRoom> furnished_room() {
  static const auto kRoom = test::cloud_room(test::furnished_room());
  return kRoom;
}

TEST(CloudRoom, SampleIsEvenAndInFreeCells) {
  const auto room = furnished_room();
  ASSERT_NE(room, nullptr);
  ASSERT_EQ(room->sample.size(), kSampleBoxes);
  const auto is_free = [&](std::uint32_t box) {
    return room->space->free[room->lattice.cell(box)] != 0;
  };
  std::vector<double> in_quarter(4);
  for (const CloudRoom::SampleBox& one : room->sample) {
    ASSERT_LT(one.box, room->lattice.size());
    EXPECT_TRUE(is_free(one.box));
    EXPECT_EQ(one.middle, room->lattice.middle(one.box));
    in_quarter[quarter(one.middle)] += 1.0;
  }
  std::vector<double> free_in_quarter(4);
  double free = 0.0;
  for (std::uint32_t box = 0; box < room->lattice.size(); ++box) {
    if (is_free(box)) {
      const Vec3d middle = room->lattice.middle(box);
      free_in_quarter[quarter(middle)] += 1.0;
      free += 1.0;
    }
  }
  EXPECT_EQ(room->boxes, free);
  EXPECT_LT(room->boxes, static_cast<double>(room->lattice.size()));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(in_quarter[i] / static_cast<double>(kSampleBoxes), free_in_quarter[i] / free, 0.03);
  }
}

// The heights of the sample are as probable as those of a device.
TEST(CloudRoom, SampleHasTheHeightsOfADevice) {
  const auto room = furnished_room();
  ASSERT_FALSE(room->lattice.is_height_known());
  const Grid& grid = room->lattice.grid();
  double mean = 0.0;
  std::set<double> heights;
  for (const CloudRoom::SampleBox& one : room->sample) {
    mean += one.middle.z / static_cast<double>(kSampleBoxes);
    heights.insert(one.middle.z);
  }
  EXPECT_GE(heights.size(), 2U);
  EXPECT_NEAR(mean, grid.first.z, 0.1);
}

// Those of a moment are in different parts of the room.
TEST(CloudRoom, SuccessiveBoxesAreApart) {
  const auto room = open_room();
  for (std::size_t first = 0; first < kSampleBoxes; first += kBoxesOfMoment) {
    for (std::size_t i = first; i < first + kBoxesOfMoment; ++i) {
      for (std::size_t k = first; k < i; ++k) {
        EXPECT_GT(norm(room->sample[i].middle - room->sample[k].middle), 0.5);
      }
    }
  }
}

TEST(CloudRoom, IsTheSameForTheSameRoom) {
  const auto one = furnished_room();
  const auto other = test::cloud_room(test::furnished_room());
  for (std::size_t i = 0; i < kSampleBoxes; ++i) {
    EXPECT_EQ(one->sample[i].box, other->sample[i].box);
  }
}

// A single free cell that is in no middle of a box: then all boxes count.
TEST(CloudRoom, FillsTheSampleInAFullRoom) {
  const auto room = open_room();
  FreeSpace full = *room->space;
  std::fill(full.free.begin(), full.free.end(), std::uint8_t{0});
  full.free[full.grid.count_y + 1] = 1;
  const auto none = make_cloud_room(room->localizer, std::make_shared<const FreeSpace>(full));
  EXPECT_EQ(none->sample.size(), kSampleBoxes);
  EXPECT_EQ(none->boxes, static_cast<double>(none->lattice.size()));
  full.free[room->lattice.cell(5)] = 1;
  const auto one = make_cloud_room(room->localizer, std::make_shared<const FreeSpace>(full));
  ASSERT_EQ(one->sample.size(), kSampleBoxes);
  EXPECT_EQ(one->boxes, 1.0);
  EXPECT_EQ(one->sample.back().box, 5U);
}

TEST(CloudRoom, NeedsALikelihoodOfPlaces) {
  LocalizerOptions options;
  options.likelihood = LikelihoodKind::kCoherent;
  EXPECT_EQ(test::cloud_room(test::make_room(), options), nullptr);
}

}  // namespace
}  // namespace rayloc::cloud_room_test
