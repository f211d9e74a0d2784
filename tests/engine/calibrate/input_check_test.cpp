#include "engine/calibrate/input_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "engine/observe/burst.h"
#include "tests/support/synthetic_room.h"

namespace rayloc {
namespace {

constexpr int kPerAxis = 6;
constexpr std::size_t kCount = kPerAxis * kPerAxis;

// A device on a square grid that lies inside of the room also with x and y exchanged. No two rows
// or columns mirror each other.
const std::vector<CalibrationPoint>& survey() {
  static const std::vector<CalibrationPoint> points = [] {
    const RoomModel room = test::make_room();
    std::vector<CalibrationPoint> made;
    for (int i = 0; i < kPerAxis; ++i) {
      for (int j = 0; j < kPerAxis; ++j) {
        CalibrationPoint point;
        point.position = {-0.9 + 0.31 * i, -0.85 + 0.33 * j, 1.2};
        const auto frames = test::frames_at(
            room, point.position, {2, 30.0, static_cast<unsigned>(1 + kPerAxis * i + j)});
        for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
          const auto burst = combine_burst(
              frames, {static_cast<int>(ap), room.grid, room.access_points[ap].cores, {}});
          point.h.push_back(burst.value().h);
        }
        made.push_back(std::move(point));
      }
    }
    return made;
  }();
  return points;
}

RoomModel surveyed_room() {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.gains = {};
  }
  return room;
}

std::string refusal(const std::vector<CalibrationPoint>& points) {
  const auto checked = check_calibration_inputs(surveyed_room(), points);
  return checked ? "passes" : checked.error().message;
}

testing::AssertionResult says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos
             ? testing::AssertionSuccess()
             : testing::AssertionFailure() << "'" << message << "' does not say '" << part << "'";
}

TEST(CalibrationInputCheck, PassesARightSurvey) {
  const auto checked = check_calibration_inputs(surveyed_room(), survey());
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_TRUE(checked->empty()) << checked->front().point << ' ' << checked->front().reason;
}

TEST(CalibrationInputCheck, NamesExchangedColumns) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    std::swap(point.position.x, point.position.y);
  }
  const std::string message = refusal(points);
  EXPECT_TRUE(says(message, "with x and y exchanged"));
  for (const char* ap : {" at a, ", " at b, ", " at c)"}) {
    EXPECT_TRUE(says(message, ap));
  }
  EXPECT_TRUE(says(message, "most clearly the one stated to be at ("));
}

TEST(CalibrationInputCheck, NamesAnAxisThatRunsTheOtherWay) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    point.position.y = -point.position.y;
  }
  EXPECT_TRUE(says(refusal(points), "with the sign of y changed"));
}

TEST(CalibrationInputCheck, NamesRowsThatAreOneOff) {
  auto points = survey();
  for (std::size_t i = 0; i < kCount; ++i) {
    points[i].position = survey()[(i + 1) % kCount].position;
  }
  EXPECT_TRUE(says(refusal(points), "one row down"));
}

TEST(CalibrationInputCheck, NamesExchangedAccessPoints) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    std::swap(point.h[1], point.h[2]);
  }
  const std::string message = refusal(points);
  EXPECT_TRUE(says(message, "access point 'b'"));
  EXPECT_TRUE(says(message, "access point 'c'"));
  EXPECT_FALSE(says(message, "access point 'a'"));
}

TEST(CalibrationInputCheck, NamesAnAccessPointThatWasExchangedWithOneNotRecorded) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    point.h[0] = std::move(point.h[2]);
    point.h[1].clear();
    point.h[2].clear();
  }
  EXPECT_TRUE(
      says(refusal(points), "given for access point 'a' fits the place of access point 'c'"));
}

// Recordings of a and b exchanged, where the site lists the chains of b in another order: what was
// heard by a, array chains 2 0 3, is then read as 3 0 2.
TEST(CalibrationInputCheck, ReadsChainsInTheOrderOfTheOtherAccessPoint) {
  RoomModel room = surveyed_room();
  std::swap(room.access_points[1].cores[0], room.access_points[1].cores[2]);
  std::swap(room.access_points[1].array.element_offset[0],
            room.access_points[1].array.element_offset[2]);
  auto points = survey();
  for (CalibrationPoint& point : points) {
    auto& h = point.h[1] = std::move(point.h[0]);
    const auto last = h.end() - static_cast<std::ptrdiff_t>(room.grid.size());
    std::swap_ranges(last, h.end(), h.begin());
    point.h[0].clear();
    point.h[2].clear();
  }
  const auto checked = check_calibration_inputs(room, points);
  ASSERT_FALSE(checked);
  EXPECT_TRUE(says(checked.error().message,
                   "given for access point 'b' fits the place of access point 'a'"));
}

TEST(CalibrationInputCheck, RefusesTheOnePointThatStoodElsewhere) {
  auto points = survey();
  points[8].position = {0.75, 0.9, 1.2};
  const auto checked = check_calibration_inputs(surveyed_room(), points);
  ASSERT_TRUE(checked) << checked.error().message;
  ASSERT_EQ(checked->size(), 1U);
  EXPECT_EQ(checked->front().point, 8U);
  EXPECT_TRUE(says(checked->front().reason, "wrong place or time?"));
  EXPECT_TRUE(says(checked->front().reason, "(a), "));
}

TEST(CalibrationInputCheck, SaysNothingOfFewPoints) {
  auto points = survey();
  points.resize(kLeastPairs - 1);
  for (CalibrationPoint& point : points) {
    point.position.y = -point.position.y;
    point.h[1].clear();
    point.h[2].clear();
  }
  EXPECT_EQ(refusal(points), "passes");
}

std::vector<PointFit> fits_of(const std::vector<double>& after) {
  std::vector<PointFit> fits;
  for (std::size_t i = 0; i < after.size(); ++i) {
    fits.push_back({i, 0, 0.0, after[i]});
  }
  return fits;
}

TEST(MisfittingPoints, AreThoseFarBelowTheOthers) {
  std::vector<double> after;
  for (int i = 0; i < 30; ++i) {
    after.push_back(0.95 + 0.001 * i);
  }
  after[17] = 0.2;
  const auto refused = misfitting_points(surveyed_room(), fits_of(after), &PointFit::after);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused.front().point, 17U);
  EXPECT_TRUE(says(refused.front().reason, "0.20 (a) where the others fit by 0.96"));
}

TEST(MisfittingPoints, AreNotThoseOfAWideSpread) {
  std::vector<double> after;
  for (int i = 0; i < 30; ++i) {
    after.push_back(0.05 + 0.03 * i);
  }
  EXPECT_TRUE(misfitting_points(surveyed_room(), fits_of(after), &PointFit::after).empty());
}

TEST(MisfittingPoints, AreNotFoundAmongIdenticalFits) {
  std::vector<double> after(30, 0.97);
  after[4] = 0.95;
  EXPECT_TRUE(misfitting_points(surveyed_room(), fits_of(after), &PointFit::after).empty());
}

}  // namespace
}  // namespace rayloc
