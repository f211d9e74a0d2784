// Tests the training of a method on frames of a synthetic room.
#include "daemon/lab/train/train_method.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/lab/calibrate/holdout.h"
#include "daemon/methods/method_registry.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::train_method_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TrainSurvey survey_of(const RoomModel& room) {
  TrainSurvey survey;
  unsigned seed = 1;
  for (double x = -1.0; x < 1.05; x += 0.5) {
    for (double y = -0.8; y < 0.85; y += 0.5) {
      const Vec3d place{x, y, 1.2};
      survey.points.push_back({place, test::frames_at(room, place, {.seed = seed++})});
    }
  }
  return survey;
}

// 20 points, four of them held out, and a small training of a network.
const TrainInputs& inputs() {
  static const TrainInputs kInputs = [] {
    TrainInputs made;
    made.method = find_method("cifi");
    made.settings.values = {{"epochs", 2.0}, {"images", 2.0}};
    made.room = std::make_shared<const RoomModel>(test::make_room());
    made.survey = survey_of(*made.room);
    made.held = draw_holdout(made.survey.points.size(), 0.2, 1);
    made.hash = "inputs";
    return made;
  }();
  return kInputs;
}

class TrainMethod : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::path(::testing::TempDir()) /
                     ("train_method_" + std::to_string(::getpid()) + "_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(TrainMethod, ChecksThePointsThatAreHeldOut) {
  std::vector<double> shares;
  Observer observer;
  observer.on_progress = [&](double share, const std::string&) { shares.push_back(share); };
  observer.on_note = [](const std::string& note) { ADD_FAILURE() << note; };
  const auto trained = train_method(inputs(), {}, observer, {});
  ASSERT_TRUE(trained) << trained.error().message;
  EXPECT_EQ(trained->training->method, "cifi");
  EXPECT_EQ(trained->training->network->places.size(), 16U);
  ASSERT_TRUE(trained->held_out);
  EXPECT_EQ(trained->held_out->n, 4U);
  EXPECT_GT(trained->seconds, 0.0);
  ASSERT_EQ(shares.size(), 4U) << "two stages of two epochs";
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

TEST_F(TrainMethod, ContinuesAfterAStop) {
  std::stop_source stop;
  Observer observer;
  observer.on_progress = [&](double, const std::string&) { stop.request_stop(); };
  const auto stopped = train_method(inputs(), {folder_, false}, observer, stop.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(stopped.error().message, HasSubstr("cifi"));
  const auto resumed = train_method(inputs(), {folder_, true}, {}, {});
  ASSERT_TRUE(resumed) << resumed.error().message;
  const auto whole = train_method(inputs(), {}, {}, {});
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(resumed->training->network->parameters, whole->training->network->parameters);
  EXPECT_EQ(resumed->training->network->loss, whole->training->network->loss);
}

TEST_F(TrainMethod, NotesACheckpointThatCannotBeWritten) {
  std::ofstream(folder_) << "a file";
  std::vector<std::string> notes;
  Observer observer;
  observer.on_note = [&](const std::string& note) { notes.push_back(note); };
  ASSERT_TRUE(train_method(inputs(), {folder_ / "training", false}, observer, {}));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], HasSubstr("--resume"));
}

TEST_F(TrainMethod, NeedsACheckpointToResumeFrom) {
  const auto trained = train_method(inputs(), {folder_, true}, {}, {});
  ASSERT_FALSE(trained);
  EXPECT_EQ(trained.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(trained.error().message, HasSubstr("cifi.checkpoint.json"));
}

}  // namespace
}  // namespace rayloc::train_method_test
