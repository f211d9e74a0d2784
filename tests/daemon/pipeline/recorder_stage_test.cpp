#include "daemon/pipeline/record/recorder_stage.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "capture/source/pcap_source.h"
#include "daemon/pipeline/shared/receiver_pool.h"
#include "tests/support/read_to_end.h"

namespace rayloc::recorder_stage_test {
namespace {

class RecorderStageTest : public ::testing::Test {
 protected:
  RecorderStageTest() { std::filesystem::remove_all(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<RotatingRecorder> recorder(const std::string& sub_folder = "") const {
    RotatingRecorderOptions options;
    options.folder = folder_ / sub_folder;
    options.name = "ap1";
    options.free_bytes = [] { return std::uint64_t{1} << 40U; };
    return std::make_unique<RotatingRecorder>(std::move(options));
  }

  void tap(RecorderStage& stage, int count) {
    std::vector<Datagram> datagrams;
    for (int i = 0; i < count; ++i) {
      Datagram datagram;
      datagram.time = Timestamp(std::chrono::microseconds(1'718'000'000'000'000 + next_++));
      datagram.payload = payload_;
      datagrams.push_back(datagram);
    }
    stage.tap(datagrams);
  }

  // The counters of the only recording.
  SourceCounters recorded() const {
    const std::filesystem::directory_iterator file(folder_);
    const auto source = PcapFileSource::open(file->path().string()).value();
    test::read_to_end(*source);
    return source->counters();
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("recorder_stage." + std::to_string(getpid()));
  std::vector<std::byte> payload_ = std::vector<std::byte>(566);
  int next_ = 0;
};

TEST_F(RecorderStageTest, WritesEverythingBeforeItEnds) {
  RecorderStage stage(recorder());
  for (int i = 0; i < 50; ++i) {
    tap(stage, 100);
  }
  stage.finish();
  const RecorderStageCounters counters = stage.counters();
  EXPECT_EQ(counters.tapped, 5000U);
  EXPECT_EQ(counters.written, 5000U);
  EXPECT_EQ(counters.dropped, 0U);
  EXPECT_EQ(counters.waiting, 0U);
  EXPECT_EQ(counters.files.files, 1U);
  EXPECT_EQ(recorded().delivered, 5000U);
}

TEST_F(RecorderStageTest, SeveralShareAThread) {
  ReceiverPool writers({1, RecorderStage::kWriteInterval});
  std::filesystem::create_directories(folder_);
  std::vector<std::unique_ptr<RecorderStage>> stages;
  for (const char* const sub_folder : {"one", "two", "three"}) {
    stages.push_back(std::make_unique<RecorderStage>(recorder(sub_folder), &writers));
  }
  for (int i = 0; i < 50; ++i) {
    for (const auto& stage : stages) {
      tap(*stage, 100);
    }
  }
  EXPECT_EQ(writers.threads(), 1U);
  for (const auto& stage : stages) {
    stage->finish();
    const RecorderStageCounters counters = stage->counters();
    EXPECT_EQ(counters.written, 5000U);
    EXPECT_EQ(counters.waiting, 0U);
    EXPECT_EQ(counters.files.files, 1U);
    EXPECT_TRUE(stage->progress().resting());
  }
}

TEST_F(RecorderStageTest, DropsTheNewestCountsAndMarksIt) {
  RecorderStage stage(recorder(), nullptr, 10 * payload_.size());
  tap(stage, 100);  // one call, which the writing thread cannot get between
  stage.finish();
  const RecorderStageCounters counters = stage.counters();
  EXPECT_EQ(counters.tapped, 100U);
  EXPECT_EQ(counters.written, 10U);
  EXPECT_EQ(counters.dropped, 90U);
  EXPECT_EQ(recorded().delivered, 10U);
  EXPECT_EQ(recorded().unrecorded, 90U);
}

}  // namespace
}  // namespace rayloc::recorder_stage_test
