#include "daemon/site/survey/planned_points.h"

#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::planned_points_test {
namespace {

using ::testing::HasSubstr;

class PlannedPoints : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  Expected<std::vector<PlannedPoint>> load(const std::string& text) const {
    std::ofstream(file_) << text;
    return load_planned_points(file_);
  }
  const std::filesystem::path file_ =
      ::testing::TempDir() + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
      "_plan.csv";
};

TEST_F(PlannedPoints, ReadBackAsWritten) {
  const std::vector<PlannedPoint> points = {{"p01", {1.25, -0.5, 1.2}}, {"door", {0, 2, 1.1}}};
  const auto read = load(to_csv(points));
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ((*read)[0].name, "p01");
  EXPECT_EQ((*read)[0].position, (Vec3d{1.25, -0.5, 1.2}));
  EXPECT_EQ((*read)[1].name, "door");
}

TEST_F(PlannedPoints, AreNumberedIfTheyHaveNoNames) {
  const auto read = load("z,x,y\n1.2,0,1\n1.2,0,2\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ((*read)[1].name, "p2");
  EXPECT_EQ((*read)[1].position, (Vec3d{0, 2, 1.2}));
}

TEST_F(PlannedPoints, RefuseTwoOfOneName) {
  EXPECT_THAT(load("x,y,z,name\n1,1,1,a\n2,1,1,a\n").error().message,
              HasSubstr("plan.csv:3:7: 'a' is the name of another point"));
}

TEST_F(PlannedPoints, RefuseAFileWithoutPoints) {
  EXPECT_FALSE(load("x,y,z,name\n"));
  EXPECT_THAT(load("x,y,name\n1,1,a\n").error().message, HasSubstr("no column z"));
}

}  // namespace
}  // namespace rayloc::planned_points_test
