#include "daemon/lab/evaluate/truth.h"

#include <gtest/gtest.h>

#include "daemon/site/survey/csv_table.h"

namespace rayloc::truth_test {
namespace {

using namespace std::chrono_literals;

Expected<std::vector<TruthPoint>> read(const std::string& text) {
  return read_truth(*CsvTable::parse(text, "t.csv"));
}

PublishedEstimate estimate_at(Duration time, double x) {
  PublishedEstimate published;
  published.estimate.time = Timestamp(time);
  published.estimate.position = Vec3d{x, 0, 0};
  return published;
}

// The x of what answers for each point; -1 for nothing.
std::vector<double> answers(const std::vector<TruthPoint>& truth,
                            const std::vector<PublishedEstimate>& estimates) {
  std::vector<double> xs;
  for (const LocationEstimate* match : match(truth, estimates)) {
    xs.push_back(match == nullptr ? -1.0 : match->position->x);
  }
  return xs;
}

TEST(Truth, ReadsPointsAndInstants) {
  const auto points = read("t_start,t_end,x,y,z,los\n10.5,11,1,2,3,0\n");
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_FALSE(points->at(0).instant);
  EXPECT_EQ(points->at(0).begin.time_since_epoch(), 10500ms);
  EXPECT_EQ(points->at(0).end.time_since_epoch(), 11s);
  EXPECT_EQ(points->at(0).position, (Vec3d{1, 2, 3}));

  const auto instants = read("t,x,y,z\n10.5,1,2,3\n10.6,1,2,4\n");
  ASSERT_TRUE(instants) << instants.error().message;
  ASSERT_EQ(instants->size(), 2U);
  EXPECT_TRUE(instants->at(0).instant);
  EXPECT_EQ(instants->at(1).begin.time_since_epoch(), 10600ms);
}

TEST(Truth, ErrorsNameFileLineAndColumn) {
  EXPECT_EQ(read("t,x,y\n").error().message,
            "t.csv:1:1: no column z; the first line names the columns: t,x,y,z");
  EXPECT_EQ(read("t,x,y,z\n1,2,3,4\n1,2,three,4\n").error().message,
            "t.csv:3:5: \"three\" is not a number");
  EXPECT_EQ(read("a,b\n").error().message,
            "t.csv:1:1: no column t_start, t_end, x, y, z; the first line names the columns: "
            "t_start,t_end,x,y,z");
}

TEST(Truth, APointTakesTheLastEstimateUpToATenthOfASecondAfterIt) {
  const std::vector<TruthPoint> truth{{Timestamp(10s), Timestamp(11s), false, {}},
                                      {Timestamp(20s), Timestamp(21s), false, {}},
                                      {Timestamp(30s), Timestamp(31s), false, {}}};
  EXPECT_EQ(answers(truth,
                    {estimate_at(10s, 1),
                     estimate_at(11s, 2),
                     estimate_at(11100ms, 3),
                     estimate_at(11100ms + 1ns, 4),
                     estimate_at(20s - 1ns, 5),
                     estimate_at(30s, 6)}),
            (std::vector<double>{3, -1, 6}));
}

TEST(Truth, TheOrderOfTheFileDoesNotMatter) {
  const std::vector<TruthPoint> truth{{Timestamp(10s), Timestamp(11s), false, {}}};
  EXPECT_EQ(answers(truth, {estimate_at(10900ms, 2), estimate_at(12s, 3), estimate_at(10s, 1)}),
            (std::vector<double>{2}));
}

TEST(Truth, AnInstantTakesTheNearestWithin60Milliseconds) {
  std::vector<TruthPoint> truth;
  for (const Duration time : {10s + 0ms, 10030ms, 10050ms, 10161ms, 20000ms}) {
    truth.push_back({Timestamp(time), Timestamp(time), true, {}});
  }
  EXPECT_EQ(answers(truth,
                    {estimate_at(10s, 1),
                     estimate_at(10060ms, 2),
                     estimate_at(10100ms, 3),
                     estimate_at(19939ms, 4),
                     estimate_at(20060ms, 5)}),
            (std::vector<double>{1, 1, 2, -1, 5}));
}

TEST(Truth, ShiftsByTheClockOffset) {
  const auto truth = shifted({{Timestamp(10s), Timestamp(11s), false, {}}}, 1500ms);
  EXPECT_EQ(truth[0].begin, Timestamp(11500ms));
  EXPECT_EQ(truth[0].end, Timestamp(12500ms));
}

TEST(Truth, WithoutEstimatesNothingMatches) {
  EXPECT_EQ(answers({{Timestamp(10s), Timestamp(11s), false, {}},
                     {Timestamp(10s), Timestamp(10s), true, {}}},
                    {}),
            (std::vector<double>{-1, -1}));
}

}  // namespace
}  // namespace rayloc::truth_test
