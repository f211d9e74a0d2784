#include "daemon/lab/train/training_checkpoint.h"

#include <unistd.h>

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/model/site_copy.h"

namespace rayloc::training_checkpoint_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class TrainingCheckpointFile : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_checkpoint(folder_, "cifi", "inputs", written())); }
  void TearDown() override { fs::remove_all(folder_); }

  static TrainingCheckpoint written() {
    TrainingCheckpoint checkpoint;
    checkpoint.stage = 1;
    checkpoint.temperature = 4.0 / 3.0;
    checkpoint.residual = 0.02;
    checkpoint.network.epoch = 3;
    checkpoint.network.steps = 42;
    checkpoint.network.parameters = {1.0F, -2.5F};
    checkpoint.network.mean = {0.25F, 1e-7F};
    checkpoint.network.square = {3.0F, 0.0F};
    checkpoint.network.loss = {2.0 / 3.0, 0.5, 0.25};
    return checkpoint;
  }
  std::string refusal(const std::string& inputs = "inputs") const {
    const auto read = read_checkpoint(folder_, "cifi", inputs);
    EXPECT_FALSE(read);
    return read ? "" : read.error().message;
  }
  fs::path file(const std::string& extension) const {
    return folder_ / ("cifi.checkpoint." + extension);
  }

  fs::path folder_ = fs::path(::testing::TempDir()) /
                     ("training_checkpoint_" + std::to_string(::getpid()) + "_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(TrainingCheckpointFile, ReadsBackBitForBit) {
  const auto read = read_checkpoint(folder_, "cifi", "inputs");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->stage, 1U);
  EXPECT_EQ(read->temperature, written().temperature);
  EXPECT_EQ(read->residual, written().residual);
  EXPECT_EQ(read->network.epoch, 3U);
  EXPECT_EQ(read->network.steps, 42U);
  EXPECT_EQ(read->network.parameters, written().network.parameters);
  EXPECT_EQ(read->network.mean, written().network.mean);
  EXPECT_EQ(read->network.square, written().network.square);
  EXPECT_EQ(read->network.loss, written().network.loss);
}

TEST_F(TrainingCheckpointFile, RefusesOtherInputs) {
  EXPECT_THAT(refusal("others"), HasSubstr("another site, survey, seed or settings"));
}

TEST_F(TrainingCheckpointFile, RefusesBrokenNumbers) {
  ASSERT_TRUE(write_file(file("json"), "{\"inputs\": \"inputs\"}"));
  EXPECT_THAT(refusal(), HasSubstr("is broken"));
  ASSERT_TRUE(write_file(file("json"), "nonsense"));
  EXPECT_THAT(refusal(), HasSubstr("is broken"));
}

TEST_F(TrainingCheckpointFile, RefusesOtherWeights) {
  TrainingCheckpoint other = written();
  other.network.mean[0] = 0.5F;
  const auto numbers = read_file(file("json"));
  ASSERT_TRUE(numbers);
  ASSERT_TRUE(write_checkpoint(folder_, "cifi", "inputs", other));
  ASSERT_TRUE(write_file(file("json"), *numbers));
  EXPECT_THAT(refusal(), HasSubstr("its weights are not those of"));
}

TEST_F(TrainingCheckpointFile, IsRemoved) {
  remove_checkpoint(folder_, "cifi");
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_THAT(refusal(), HasSubstr("train without --resume"));
}

}  // namespace
}  // namespace rayloc::training_checkpoint_test
