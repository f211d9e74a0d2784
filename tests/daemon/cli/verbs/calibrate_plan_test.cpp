#include "daemon/lab/calibrate/calibrate_plan.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/survey/planned_points.h"
#include "tests/support/test_paths.h"

namespace rayloc::cli::calibrate_plan_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string kSite = test::data_path("/sites/meeting_room");

class CalibratePlan : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) /
        (std::string("plan_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string read(const std::string& name) const {
    std::ifstream in(path(name));
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_;
};

TEST_F(CalibratePlan, WritesPointsThatSurveyReadsAndAPictureOfThem) {
  const auto done = run_plan({kSite, path("plan.csv"), "", 25, true});
  ASSERT_TRUE(done) << done.error().message;
  const auto points = load_planned_points(path("plan.csv"));
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 25U);
  EXPECT_EQ((*points)[0].name, "p01");
  EXPECT_EQ((*points)[24].name, "p25");
  std::map<double, int> heights;
  for (std::size_t i = 0; i < points->size(); ++i) {
    const PlannedPoint& point = (*points)[i];
    ++heights[point.position.z];
    EXPECT_EQ(point.position.z == 1.2, i % 3 != 2) << point.name;
    EXPECT_LT(std::abs(point.position.x), 1.765);
    EXPECT_LT(std::abs(point.position.y), 1.425);
  }
  // In turn above and below, so that the points determine the access points' height.
  EXPECT_EQ(heights, (std::map<double, int>{{0.6, 4}, {1.2, 17}, {1.8, 4}}));
  EXPECT_THAT(read("plan.svg"), HasSubstr(">p01<"));
  EXPECT_THAT(read("plan.svg"), HasSubstr(">ap3<"));
}

TEST_F(CalibratePlan, DrawsWhereItIsTold) {
  ASSERT_TRUE(run_plan({kSite, path("plan.csv"), path("room.png"), 5, true}));
  EXPECT_EQ(read("room.png").substr(1, 3), "PNG");
  EXPECT_FALSE(fs::exists(path("plan.svg")));
  const auto wrong = run_plan({kSite, path("plan.csv"), path("room.jpg"), 5, true});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
}

TEST_F(CalibratePlan, SaysWhichObjectsItSeesTooLittleOf) {
  ::testing::internal::CaptureStderr();
  ASSERT_TRUE(run_plan({kSite, path("plan.csv"), "", 3, false}));
  const std::string output = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(output, HasSubstr("3 points of "));
  EXPECT_THAT(output, HasSubstr("  whiteboard: a side of it to "));
  EXPECT_THAT(output, ::testing::Not(HasSubstr("expected accuracy"))) << "nobody has measured that";
}

TEST_F(CalibratePlan, SaysWhatSoManyPointsWereWorth) {
  ::testing::internal::CaptureStderr();
  ASSERT_TRUE(run_plan({kSite, path("plan.csv"), "", PlanArguments().points, false}));
  const std::string output = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(output, HasSubstr("12 points surveyed to 3 cm located devices to 2 cm and 9 cm"));
  EXPECT_THAT(output, HasSubstr("36 points (--plan-points 36): "));
}

}  // namespace
}  // namespace rayloc::cli::calibrate_plan_test
