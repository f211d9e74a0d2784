#include "engine/calibrate/check/input_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/calibrate/access_point_fit.h"
#include "engine/calibrate/check/array_mistakes.h"
#include "engine/observe/burst.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::input_check_test {
namespace {

constexpr int kPerAxis = 6;
constexpr auto kCount = std::size_t{kPerAxis} * kPerAxis;

// A device on a square grid that lies inside of the room also with x and y exchanged. No two rows
// or columns mirror each other.
const std::vector<CalibrationPoint>& survey() {
  static const std::vector<CalibrationPoint> kPoints = [] {
    const RoomModel room = test::make_room();
    std::vector<CalibrationPoint> made;
    for (int i = 0; i < kPerAxis; ++i) {
      for (int j = 0; j < kPerAxis; ++j) {
        CalibrationPoint point;
        point.position = {-0.9 + 0.31 * i, -0.85 + 0.33 * j, 1.2};
        const auto frames = test::frames_at(
            room, point.position, {2, 30.0, static_cast<unsigned>(1 + kPerAxis * i + j)});
        for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
          const auto burst =
              combine_burst(frames, {ap, room.grid, room.access_points[ap].rx_chains, {}});
          point.h.push_back(burst.value().h);
        }
        made.push_back(std::move(point));
      }
    }
    return made;
  }();
  return kPoints;
}

RoomModel surveyed_room() {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.gains = {};
  }
  return room;
}

std::string refusal(const std::vector<CalibrationPoint>& points) {
  const InputCheck check = check_calibration_inputs(surveyed_room(), points);
  return check.found.empty() ? "passes" : check.found.front().message;
}

::testing::AssertionResult contains(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos
             ? ::testing::AssertionSuccess()
             : ::testing::AssertionFailure() << "'" << message << "' does not say '" << part << "'";
}

TEST(CalibrationInputCheck, PassesARightSurvey) {
  const InputCheck check = check_calibration_inputs(surveyed_room(), survey());
  ASSERT_TRUE(check.found.empty()) << check.found.front().message;
  EXPECT_TRUE(check.misfits.empty())
      << check.misfits.front().point << ' ' << check.misfits.front().reason;
  for (const TriedMistake& tried : check.tried) {
    EXPECT_LT(tried.gained, 0.0) << tried.what;
  }
}

TEST(CalibrationInputCheck, NamesExchangedColumns) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    std::swap(point.position.x, point.position.y);
  }
  const std::string message = refusal(points);
  EXPECT_TRUE(contains(message, "with x and y exchanged"));
  for (const char* ap : {" at a, ", " at b, ", " at c)"}) {
    EXPECT_TRUE(contains(message, ap));
  }
  EXPECT_TRUE(contains(message, "most clearly the one stated to be at ("));
}

TEST(CalibrationInputCheck, ReportsAReversedAxis) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    point.position.y = -point.position.y;
  }
  EXPECT_TRUE(contains(refusal(points), "with the sign of y changed"));
}

TEST(CalibrationInputCheck, ReportsShiftedRows) {
  auto points = survey();
  for (std::size_t i = 0; i < kCount; ++i) {
    points[i].position = survey()[(i + 1) % kCount].position;
  }
  EXPECT_TRUE(contains(refusal(points), "one row down"));
}

TEST(CalibrationInputCheck, NamesExchangedAccessPoints) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    std::swap(point.h[1], point.h[2]);
  }
  const std::string message = refusal(points);
  EXPECT_TRUE(contains(message, "access point 'b'"));
  EXPECT_TRUE(contains(message, "access point 'c'"));
  EXPECT_FALSE(contains(message, "access point 'a'"));
}

TEST(CalibrationInputCheck, NamesAnAccessPointThatWasExchangedWithOneNotRecorded) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    point.h[0] = std::move(point.h[2]);
    point.h[1].clear();
    point.h[2].clear();
  }
  EXPECT_TRUE(
      contains(refusal(points), "given for access point 'a' fits the place of access point 'c'"));
}

// Recordings of a and b exchanged, where the site lists the chains of b in another order: the
// channels of a, array chains 2 0 3, are then read as 3 0 2.
TEST(CalibrationInputCheck, ReadsChainsInTheOrderOfTheOtherAccessPoint) {
  RoomModel room = surveyed_room();
  std::swap(room.access_points[1].rx_chains[0], room.access_points[1].rx_chains[2]);
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
  const InputCheck check = check_calibration_inputs(room, points);
  ASSERT_EQ(check.found.size(), 1U);
  EXPECT_TRUE(contains(check.found.front().message,
                       "given for access point 'b' fits the place of access point 'a'"));
}

TEST(CalibrationInputCheck, RefusesASingleMisplacedPoint) {
  auto points = survey();
  points[8].position = {0.75, 0.9, 1.2};
  const InputCheck check = check_calibration_inputs(surveyed_room(), points);
  ASSERT_TRUE(check.found.empty()) << check.found.front().message;
  ASSERT_EQ(check.misfits.size(), 1U);
  EXPECT_EQ(check.misfits.front().point, 8U);
  EXPECT_TRUE(contains(check.misfits.front().reason, "wrong place or time?"));
  EXPECT_TRUE(contains(check.misfits.front().reason, "(a), "));
}

TEST(CalibrationInputCheck, AcceptsFewPointsWithoutAVerdict) {
  auto points = survey();
  points.resize(kFewestPairs - 1);
  for (CalibrationPoint& point : points) {
    point.position.y = -point.position.y;
    point.h[1].clear();
    point.h[2].clear();
  }
  EXPECT_EQ(refusal(points), "passes");
}

// The site states the arrays otherwise than they are mounted; the recordings are right.
using Edit = void (*)(RoomAccessPoint&);
std::vector<TriedMistake> found_where(std::initializer_list<std::pair<std::size_t, Edit>> edits) {
  RoomModel room = surveyed_room();
  for (const auto& [ap, edit] : edits) {
    edit(room.access_points[ap]);
  }
  return check_calibration_inputs(room, survey()).found;
}

void turn(RoomAccessPoint& ap) { ap.array.pose.orientation.yaw += std::numbers::pi; }
void exchange_first_two(RoomAccessPoint& ap) {
  std::swap(ap.array.element_offset[0], ap.array.element_offset[1]);
}
void shift_all(RoomAccessPoint& ap) {
  std::rotate(ap.array.element_offset.begin(),
              ap.array.element_offset.begin() + 1,
              ap.array.element_offset.end());
}

TEST(Field, CalibrationCheckReportsARotatedAccessPoint) {
  const auto found = found_where({{1, turn}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().kind, TriedMistake::Kind::kArray);
  EXPECT_GT(found.front().explained, found.front().stated);
  EXPECT_TRUE(contains(found.front().message, "access point 'b'"));
  EXPECT_TRUE(contains(found.front().message, "rotated by 180 degrees"));
  EXPECT_TRUE(contains(found.front().remedy, "yaw_deg = "));
}

// Few pairs need more standard errors, and are evidence all the same.
TEST(Field, FewPairsNeedMoreStandardErrors) {
  const auto significance = [](std::size_t pairs) {
    PairedComparison comparison;
    for (std::size_t i = 0; i < pairs; ++i) {
      comparison.add({0.3}, {i % 2 == 0 ? 0.5 : 0.7});
    }
    return comparison.significance();
  };
  EXPECT_EQ(significance(kFewestPairs - 1), 0.0);
  // A mean of 0.3 over a standard error of 0.1 sqrt(6 / 5) / sqrt(6).
  EXPECT_NEAR(significance(6), 0.3 / (0.1 / std::sqrt(5.0)) * 3.0 / 5.51, 1e-12);
  EXPECT_LT(significance(11), significance(12));
  EXPECT_NEAR(significance(12), 0.3 / (0.1 / std::sqrt(11.0)), 1e-12);
}

TEST(Field, CalibrationCheckNamesExchangedCores) {
  const RoomModel room = surveyed_room();
  const auto& rx_chains = room.access_points[0].rx_chains;
  const auto found = found_where({{0, exchange_first_two}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(contains(found.front().message,
                       "with cores " + std::to_string(rx_chains[0]) + " and " +
                           std::to_string(rx_chains[1]) + " exchanged"));
}

TEST(Field, CalibrationCheckNamesCoresInAnotherOrder) {
  const auto found = found_where({{2, shift_all}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(contains(found.front().message, "access point 'c'"));
  EXPECT_TRUE(contains(found.front().message, "with its antennas wired to cores "));
  // The second antenna is at the place that the site states for its first.
  const RoomModel room = surveyed_room();
  const auto& rx_chains = room.access_points[2].rx_chains;
  EXPECT_TRUE(contains(found.front().remedy,
                       "core = " + std::to_string(rx_chains[1]) + ", " +
                           std::to_string(rx_chains[2]) + ", " + std::to_string(rx_chains[0])));
}

TEST(Field, CalibrationCheckReportsEachMisorientedAccessPoint) {
  const auto found = found_where({{0, exchange_first_two}, {2, turn}});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(contains(found[0].message, "access point 'a'"));
  EXPECT_TRUE(contains(found[1].message, "access point 'c'"));
}

// With one access point a mistake of the points may be better than nothing, too.
TEST(Field, CalibrationCheckSeparatesARotatedArrayFromARotatedSurvey) {
  RoomModel room = surveyed_room();
  turn(room.access_points[0]);
  auto points = survey();
  for (CalibrationPoint& point : points) {
    point.h[1].clear();
    point.h[2].clear();
  }
  const auto found = check_calibration_inputs(room, points).found;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().kind, TriedMistake::Kind::kArray) << found.front().message;
}

TEST(Field, CalibrationCheckReportsCyclicallyExchangedRecordings) {
  auto points = survey();
  for (CalibrationPoint& point : points) {
    std::rotate(point.h.begin(), point.h.begin() + 1, point.h.end());  // a holds the channels of b
  }
  const auto found = check_calibration_inputs(surveyed_room(), points).found;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().kind, TriedMistake::Kind::kRecordings);
  for (const char* part : {"--capture b= with what is given for a",
                           "--capture c= with what is given for b",
                           "--capture a= with what is given for c"}) {
    EXPECT_TRUE(contains(found.front().remedy, part));
  }
}

// A mistake that explains a survey in disorder would do so by chance.
TEST(Field, CalibrationCheckFindsNothingInASurveyInDisorder) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    auto points = survey();
    std::mt19937_64 random(seed);
    for (std::size_t i = points.size(); i > 1; --i) {
      std::swap(points[i - 1].h, points[random() % i].h);
    }
    EXPECT_EQ(refusal(points), "passes") << seed;
  }
}

// With two halves of seven points, neither half has gains that could judge the other.
TEST(Field, CalibrationCheckJudgesByPointsThatTheGainsHaveNotSeen) {
  const RoomModel room = surveyed_room();
  std::vector<CalibrationSample> samples;
  for (const CalibrationPoint& point : survey()) {
    samples.push_back({point.position, point.h[0]});
  }
  const auto offsets = offsets_of(room.access_points[0].array);
  const AccessPointCalibrator all(room, 0, samples);
  const auto crossed = all.crossed_correlations(offsets);
  const auto fit = all.fit_gains();
  ASSERT_TRUE(fit);
  const auto own = all.correlations(&*fit);
  double less = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_TRUE(crossed[i] && own[i]);
    less += *own[i] - *crossed[i];
  }
  EXPECT_GT(less, 0.0);
  samples.resize(7);
  const auto few = AccessPointCalibrator(room, 0, samples).crossed_correlations(offsets);
  EXPECT_TRUE(std::none_of(few.begin(), few.end(), [](const auto& one) { return one; }));
}

TEST(Field, ArrayMistakesAreAllOrdersOfFewCoresAndAllPairsOfMany) {
  RoomAccessPoint ap = surveyed_room().access_points[0];
  EXPECT_EQ(mistakes_of_array(ap).size(), 2U + 5U);  // rotated, mirrored, the other orders
  while (ap.rx_chains.size() < 6) {
    ap.rx_chains.push_back(static_cast<std::uint8_t>(10 + ap.rx_chains.size()));
    ap.array.element_offset.push_back({0.0, 0.03 * static_cast<double>(ap.rx_chains.size()), 0.0});
  }
  EXPECT_EQ(mistakes_of_array(ap).size(), 2U + 15U);
  ap.rx_chains.resize(1);
  ap.array.element_offset.resize(1);
  EXPECT_TRUE(mistakes_of_array(ap).empty());
}

// An antenna that looks one way is another one when it is rotated.
TEST(Field, ArrayMistakesShareRaysWhereTheAntennaIsRound) {
  RoomAccessPoint ap = surveyed_room().access_points[0];
  EXPECT_TRUE(share_rays(mistakes_of_array(ap)[0].array, ap.array));
  ap.array.pattern = AntennaPattern::kTr38901;
  EXPECT_FALSE(share_rays(mistakes_of_array(ap)[0].array, ap.array));
  EXPECT_TRUE(share_rays(mistakes_of_array(ap)[1].array, ap.array)) << "only its elements move";
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
  after.reserve(30);
  for (int i = 0; i < 30; ++i) {
    after.push_back(0.95 + 0.001 * i);
  }
  after[17] = 0.2;
  const auto refused = misfitting_points(surveyed_room(), fits_of(after), &PointFit::after);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused.front().point, 17U);
  EXPECT_TRUE(contains(refused.front().reason, "0.20 (a) where the others fit by 0.96"));
}

TEST(MisfittingPoints, AreNotThoseOfAWideSpread) {
  std::vector<double> after;
  after.reserve(30);
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
}  // namespace rayloc::input_check_test
