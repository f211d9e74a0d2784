#include "daemon/site/survey/survey_session.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::survey_session_test {
namespace {

using ::testing::HasSubstr;

class SurveySessionTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove(points_); }
  void TearDown() override { std::filesystem::remove(points_); }

  // Ports are those of access points 0, 1, ... on free ports.
  SurveySession session(std::vector<PlannedPoint> plan, std::size_t ports = 0) const {
    std::vector<SurveyPort> wanted;
    for (std::size_t i = 0; i < ports; ++i) {
      wanted.push_back({i, "127.0.0.1:0", ""});
    }
    return {*load_room_model(site_),
            *SurveyListener::open(site_, wanted),
            *SurveyFile::open(points_),
            std::move(plan)};
  }

  const Site site_ = *load_site(test::data_path("/sites/meeting_room"));
  const std::string points_ = std::filesystem::path(::testing::TempDir()) /
                              (std::string("survey_session_") +
                               ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                               "_" + std::to_string(::getpid()) + ".csv");
};

const std::vector<PlannedPoint> kPlan = {{"a", {0.5, 0.2, 1.2}}, {"b", {-0.5, 0.25, 1.2}}};

TEST_F(SurveySessionTest, RefusesAPointOutsideOfTheRoom) {
  const auto answer = session({}).parse_answer("9,0,1.2");
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("outside of the room: x -1."));
  EXPECT_TRUE(session({}).parse_answer("0.5,0.2,1.2"));
  EXPECT_TRUE(session({}).parse_answer("q")->quit);
}

TEST_F(SurveySessionTest, UsesTheHeightOfTheDevices) {
  const auto answer = session({}).parse_answer("0.5,0.2");
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->point.position, (Vec3d{0.5, 0.2, 1.2}));
}

TEST_F(SurveySessionTest, TheNextPlannedPointIsTheFirstWithoutARow) {
  SurveySession survey = session(kPlan);
  ASSERT_NE(survey.next_planned(), nullptr);
  EXPECT_EQ(survey.next_planned()->name, "a");
  EXPECT_EQ(survey.parse_answer("")->point.name, "a");
  const Timestamp start{std::chrono::seconds(1'700'000'000)};
  ASSERT_TRUE(survey.write({start, {3}, false}, {0.505, 0.2, 1.2}));
  EXPECT_EQ(survey.points_written(), 1U);
  EXPECT_EQ(survey.next_planned()->name, "b");
  // Another part of the survey continues the file.
  EXPECT_EQ(session(kPlan).next_planned()->name, "b");
  ASSERT_TRUE(survey.write({start, {3}, false}, {-0.5, 0.25, 1.2}));
  EXPECT_EQ(survey.next_planned(), nullptr);
}

TEST_F(SurveySessionTest, APointEndsEarlyAtTheTimeoutOrByASignal) {
  SurveySession survey = session({}, 1);
  int reads = 0;
  CountControl control;
  control.on_counts = [&](const std::vector<std::size_t>& counts) {
    EXPECT_EQ(counts, std::vector<std::size_t>{0});
    ++reads;
  };
  control.is_interrupted = [] { return false; };
  control.is_ended_early = [&] { return reads == 2; };
  const auto early = survey.count_frames({1, std::chrono::hours(1)}, control);
  ASSERT_TRUE(early) << early.error().message;
  EXPECT_EQ(reads, 2);
  EXPECT_FALSE(early->is_interrupted);
  EXPECT_FALSE(early->has_frames());

  control.is_ended_early = [] { return false; };
  const auto late = survey.count_frames({1, std::chrono::milliseconds(1)}, control);
  ASSERT_TRUE(late);
  EXPECT_FALSE(late->is_interrupted);

  control.is_interrupted = [] { return true; };
  const auto interrupted = survey.count_frames({1, std::chrono::hours(1)}, control);
  ASSERT_TRUE(interrupted);
  EXPECT_TRUE(interrupted->is_interrupted);
}

}  // namespace
}  // namespace rayloc::survey_session_test
