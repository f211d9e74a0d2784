#include "daemon/lab/predict/planned_room.h"
#include "tests/support/test_paths.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rayloc::planned_room_test {
namespace {

Site meeting_room() { return *load_site(test::data_path("/sites/meeting_room")); }

TEST(PlannedRoom, HasUnitChainGainsAndPostCalibrationErrors) {
  const auto room = planned_room(meeting_room(), {});
  ASSERT_TRUE(room) << room.error().message;
  ASSERT_EQ(room->access_points.size(), 3U);
  for (const RoomAccessPoint& ap : room->access_points) {
    EXPECT_EQ(ap.gains.gain.size(), ap.rx_chains.size() * room->grid.size());
    EXPECT_LT(ap.error.plan_tolerance, ModelError().plan_tolerance);
  }
}

TEST(PlannedRoom, KeepsTheAccessPointsThatAreNamedInTheirOrder) {
  const auto room = planned_room(meeting_room(), {.access_points = {"ap3", "ap1"}});
  ASSERT_TRUE(room);
  ASSERT_EQ(room->access_points.size(), 2U);
  EXPECT_EQ(room->access_points[0].id, "ap3");
  EXPECT_EQ(room->access_points[1].id, "ap1");
  const auto unknown = planned_room(meeting_room(), {.access_points = {"ap9"}});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("'ap9'"), std::string::npos);
  const auto twice = planned_room(meeting_room(), {.access_points = {"ap1", "ap2", "ap1"}});
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().kind, ErrorKind::kUsage);
  EXPECT_NE(twice.error().message.find("'ap1' is named twice"), std::string::npos);
}

TEST(PlannedRoom, HasNoSpacingOfAntennasThatAreNoRow) {
  const auto spaced = planned_room(meeting_room(), {.spacing = 0.03});
  ASSERT_TRUE(spaced) << spaced.error().message;
  EXPECT_NEAR(gaps_of(spaced->access_points[0].array).at(1), 0.03, 1e-12);
  Site corner = meeting_room();
  corner.access_points[1].array.element_offset[1].z = 0.05;
  const auto refused = planned_room(corner, {.spacing = 0.03});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  EXPECT_NE(refused.error().message.find("'ap2' are no row"), std::string::npos);
  EXPECT_TRUE(planned_room(corner, {.access_points = {"ap1"}, .spacing = 0.03}));
}

TEST(PlannedRoom, HasTheTonesOfAnotherBandwidth) {
  const auto narrow = planned_room(meeting_room(), {.bandwidth_mhz = 20});
  const auto wide = planned_room(meeting_room(), {.bandwidth_mhz = 80});
  ASSERT_TRUE(narrow && wide);
  EXPECT_EQ(narrow->grid.size(), 56U);  // of a VHT frame of 20 MHz
  EXPECT_EQ(wide->grid.size(), 242U);   // and of 80 MHz
  EXPECT_EQ(wide->access_points[0].gains.grid, wide->grid);
}

TEST(PlannedRoom, MovesTheAntennasOfARowAboutItsMiddle) {
  AntennaArray row;
  row.element_offset = {{0, -0.089, 0}, {0, 0, 0}, {0, 0.089, 0}};
  EXPECT_EQ(gaps_of(row), (std::vector<double>{0.089, 0.089}));
  set_gaps(row, {0.03, 0.06});
  EXPECT_NEAR(gaps_of(row)[0], 0.03, 1e-12);
  EXPECT_NEAR(gaps_of(row)[1], 0.06, 1e-12);
  EXPECT_NEAR(row.element_offset.front().y + row.element_offset.back().y, 0.0, 1e-12);
  AntennaArray corner = row;
  corner.element_offset[1].z = 0.05;
  EXPECT_TRUE(gaps_of(corner).empty());
  const auto before = corner.element_offset;
  set_gaps(corner, {0.1, 0.1});
  EXPECT_EQ(corner.element_offset, before);
}

}  // namespace
}  // namespace rayloc::planned_room_test
