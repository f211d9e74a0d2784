#include "daemon/cli/calibration/plan_report.h"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/survey/planned_points.h"
#include "tests/support/test_paths.h"

namespace rayloc::cli::plan_report_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string kSite = test::data_path("/sites/meeting_room");

class PlanReport : public ::testing::Test {
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
  // Standard error of a plan of `points` points.
  std::string printed(std::size_t points) const {
    const auto planned = run_plan({kSite, points});
    ::testing::internal::CaptureStderr();
    EXPECT_TRUE(planned && write_plan(*planned, {path("plan.csv"), "", false}));
    return ::testing::internal::GetCapturedStderr();
  }

  fs::path folder_;
};

TEST_F(PlanReport, WritesPointsThatSurveyReadsAndAPictureOfThem) {
  const auto planned = run_plan({kSite, 25});
  ASSERT_TRUE(planned) << planned.error().message;
  const auto done = write_plan(*planned, {path("plan.csv"), "", true});
  ASSERT_TRUE(done) << done.error().message;
  const auto points = load_planned_points(path("plan.csv"));
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 25U);
  for (std::size_t i = 0; i < points->size(); ++i) {
    EXPECT_EQ((*points)[i].name, planned->points[i].name);
    EXPECT_NEAR((*points)[i].position.x, planned->points[i].position.x, 0.0005);
    EXPECT_NEAR((*points)[i].position.z, planned->points[i].position.z, 0.0005);
  }
  EXPECT_THAT(read("plan.svg"), HasSubstr(">p01<"));
  EXPECT_THAT(read("plan.svg"), HasSubstr(">ap3<"));
}

TEST_F(PlanReport, DrawsIntoTheStatedFile) {
  const auto planned = run_plan({kSite, 5});
  ASSERT_TRUE(planned) << planned.error().message;
  ASSERT_TRUE(write_plan(*planned, {path("plan.csv"), path("room.svg"), true}));
  EXPECT_THAT(read("room.svg"), HasSubstr("<svg"));
  EXPECT_FALSE(fs::exists(path("plan.svg")));
  const auto wrong = write_plan(*planned, {path("plan.csv"), path("room.jpg"), true});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
}

TEST_F(PlanReport, PrintsObjectsWithTooFewPoints) {
  const std::string output = printed(3);
  EXPECT_THAT(output, HasSubstr("3 points of "));
  EXPECT_THAT(output, HasSubstr("  whiteboard: a side of it to "));
  EXPECT_THAT(output, ::testing::Not(HasSubstr("expected accuracy"))) << "was not measured";
}

TEST_F(PlanReport, PrintsTheMeasuredAccuracyOfAsManyPoints) {
  const std::string output = printed(PlanArguments().points);
  EXPECT_THAT(output, HasSubstr("12 points surveyed to 3 cm located devices to 2 cm and 9 cm"));
  EXPECT_THAT(output, HasSubstr("36 points (--plan-points 36): "));
}

}  // namespace
}  // namespace rayloc::cli::plan_report_test
