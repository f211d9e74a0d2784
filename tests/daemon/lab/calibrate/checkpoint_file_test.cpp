#include "daemon/lab/calibrate/checkpoint_file.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "daemon/site/model/site_copy.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::checkpoint_file_test {
namespace {

namespace fs = std::filesystem;

class CheckpointFile : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove(file_); }

  // Loads a checkpoint from a file with that text, for `points` points.
  Expected<StoredCheckpoint> load(const std::string& text, std::size_t points = 2) const {
    EXPECT_TRUE(write_file(file_, text));
    return load_checkpoint(file_, "these inputs", room_, points);
  }

  RoomModel room_ = test::make_surveyed_room({.points = 0}).plan;
  fs::path file_ = fs::path(::testing::TempDir()) /
                   (std::string("checkpoint_") +
                    ::testing::UnitTest::GetInstance()->current_test_info()->name());

  StoredCheckpoint checkpoint() const {
    StoredCheckpoint stored;
    stored.seconds = 41.0 / 3.0;
    JointCheckpoint& result = stored.reached;
    result.rounds = 3;
    result.last_kept = 1;
    for (std::size_t i = 0; i < RoomUnknowns(room_, {}).size(); ++i) {
      result.state.values.push_back(1.0 / (3.0 + static_cast<double>(i)));
    }
    result.state.survey = {{0.1, 0.2, 1.0 / 3.0}, {-1e-17, 0.0, 5.0}};
    result.other_cycles = {{1, -0.028, 1.0 / 7.0}};
    result.gains = {room_.access_points[0].gains};
    result.gains[0].gain[7] = {1.0 / 7.0, -1e-3 / 3.0};
    result.history = {{"scan", 0, 1.0 / 3.0, 0.5}, {"fit", 1, 1.0 / 9.0, 0.75}};
    return stored;
  }
};

TEST_F(CheckpointFile, ReadsBackBitForBit) {
  const StoredCheckpoint stored = checkpoint();
  const auto loaded = load(to_json_text(stored, "these inputs"));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->seconds, stored.seconds);
  const JointCheckpoint& written = stored.reached;
  const JointCheckpoint* read = &loaded->reached;
  EXPECT_EQ(read->rounds, 3);
  EXPECT_EQ(read->last_kept, 1);
  EXPECT_EQ(read->state.values, written.state.values);
  EXPECT_EQ(read->state.survey, written.state.survey);
  ASSERT_EQ(read->other_cycles.size(), 1U);
  EXPECT_EQ(read->other_cycles[0].surface, 1U);
  EXPECT_EQ(read->other_cycles[0].offset, -0.028);
  EXPECT_EQ(read->other_cycles[0].excess, 1.0 / 7.0);
  ASSERT_EQ(read->gains.size(), 1U);
  EXPECT_EQ(read->gains[0].gain, written.gains[0].gain);
  EXPECT_EQ(read->gains[0].rx_chains, written.gains[0].rx_chains);
  ASSERT_EQ(read->history.size(), 2U);
  EXPECT_EQ(read->history[1].stage, "fit");
  EXPECT_EQ(read->history[1].iteration, 1);
  EXPECT_EQ(read->history[1].loss, 1.0 / 9.0);
  EXPECT_EQ(read->history[1].heldout, 0.75);
}

TEST_F(CheckpointFile, IsRefusedOfOtherInputs) {
  const auto read = load(to_json_text(checkpoint(), "others"));
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("made from other inputs"), std::string::npos);
}

TEST_F(CheckpointFile, IsRefusedOfAnotherRoomOrSurvey) {
  StoredCheckpoint few = checkpoint();
  few.reached.state.values.pop_back();
  EXPECT_FALSE(load(to_json_text(few, "these inputs")));
  EXPECT_FALSE(load(to_json_text(checkpoint(), "these inputs"), 3));
  StoredCheckpoint more = checkpoint();
  more.reached.gains[0].gain.pop_back();
  EXPECT_FALSE(load(to_json_text(more, "these inputs")));
}

TEST_F(CheckpointFile, IsRefusedWithRoundsThatThereAreNot) {
  StoredCheckpoint wrong = checkpoint();
  wrong.reached.rounds = kJointRounds + 1;
  EXPECT_FALSE(load(to_json_text(wrong, "these inputs")));
  wrong = checkpoint();
  wrong.reached.last_kept = 3;  // of three, counted from 0
  EXPECT_FALSE(load(to_json_text(wrong, "these inputs")));
  wrong.reached.last_kept = -1;
  EXPECT_FALSE(load(to_json_text(wrong, "these inputs")));
}

TEST_F(CheckpointFile, IsRefusedWhenBroken) {
  EXPECT_FALSE(load("{"));
  EXPECT_FALSE(load("[]"));
  EXPECT_FALSE(load(R"({"inputs": "these inputs"})"));
}

TEST_F(CheckpointFile, ReportsAMissingCheckpoint) {
  const auto read = load_checkpoint(file_, "these inputs", room_, 2);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("no interrupted calibration"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::checkpoint_file_test
