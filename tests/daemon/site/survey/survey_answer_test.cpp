#include "daemon/site/survey/survey_answer.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::survey_answer_test {
namespace {

using ::testing::HasSubstr;

const std::vector<PlannedPoint> kPlan = {{"door", {1.0, 2.0, 1.3}}, {"window", {0.0, 2.5, 1.1}}};

Expected<SurveyAnswer> parse(std::string_view line) {
  return parse_survey_answer(line, kPlan, &kPlan[1], 1.2);
}

TEST(SurveyAnswer, IsAPlaceOfThreeNumbersOrTwoAtTheUsualHeight) {
  EXPECT_EQ(parse(" 0.5, -1 ,1.4 ")->point.position, (Vec3d{0.5, -1.0, 1.4}));
  EXPECT_EQ(parse("0.5,-1")->point.position, (Vec3d{0.5, -1.0, 1.2}));
  EXPECT_EQ(parse("0.5,-1")->point.name, "");
}

TEST(SurveyAnswer, IsAPlannedPointByItsName) {
  EXPECT_EQ(parse("door")->point.position, (Vec3d{1.0, 2.0, 1.3}));
  EXPECT_EQ(parse("door")->point.name, "door");
}

TEST(SurveyAnswer, EmptyInputSelectsTheNextPlannedPoint) {
  EXPECT_EQ(parse("")->point.name, "window");
  EXPECT_EQ(parse("  ")->point.name, "window");
  EXPECT_THAT(parse_survey_answer("", {}, nullptr, 1.2).error().message, HasSubstr("x,y,z"));
  EXPECT_THAT(parse_survey_answer("", kPlan, nullptr, 1.2).error().message, HasSubstr("done"));
}

TEST(SurveyAnswer, QuitsAtQ) {
  EXPECT_TRUE(parse("q")->quit);
  EXPECT_FALSE(parse("door")->quit);
}

TEST(SurveyAnswer, SuggestsAValidAnswer) {
  EXPECT_THAT(parse("windw").error().message, HasSubstr("did you mean 'window'"));
  for (const char* wrong : {"1", "1,2,3,4", "1;2;3", "1,2,nan", "1,,2", "1,2,"}) {
    EXPECT_THAT(parse(wrong).error().message, HasSubstr("neither x,y,z")) << wrong;
  }
}

}  // namespace
}  // namespace rayloc::survey_answer_test
