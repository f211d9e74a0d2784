#include "daemon/pipeline/recorder_stage.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>

#include "capture/pcap_source.h"

namespace rayloc {
namespace {

class RecorderStageTest : public ::testing::Test {
 protected:
  RecorderStageTest() { std::filesystem::remove(path_); }
  ~RecorderStageTest() override { std::filesystem::remove(path_); }

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

  std::size_t datagrams_in_file() const {
    const auto source = PcapFileSource::open(path_).value();
    DatagramBatch batch;
    std::size_t count = 0;
    while (!batch.ended) {
      EXPECT_TRUE(source->read(batch, Duration::zero()).has_value());
      count += batch.datagrams.size();
    }
    return count;
  }

  const std::string path_ =
      std::filesystem::temp_directory_path() / ("recorder_stage." + std::to_string(getpid()));
  std::vector<std::byte> payload_ = std::vector<std::byte>(566);
  int next_ = 0;
};

TEST_F(RecorderStageTest, WritesEverythingBeforeItEnds) {
  RecorderStage stage(PcapRecorder::create(path_).value());
  for (int i = 0; i < 50; ++i) {
    tap(stage, 100);
  }
  stage.finish();
  const RecorderStageCounters counters = stage.counters();
  EXPECT_EQ(counters.tapped, 5000U);
  EXPECT_EQ(counters.written, 5000U);
  EXPECT_EQ(counters.dropped, 0U);
  EXPECT_EQ(counters.waiting, 0U);
  EXPECT_EQ(datagrams_in_file(), 5000U);
}

TEST_F(RecorderStageTest, DropsTheNewestAndCountsIt) {
  RecorderStage stage(PcapRecorder::create(path_).value(), 10 * payload_.size());
  tap(stage, 100);  // one call, which the writing thread cannot get between
  stage.finish();
  const RecorderStageCounters counters = stage.counters();
  EXPECT_EQ(counters.tapped, 100U);
  EXPECT_EQ(counters.written, 10U);
  EXPECT_EQ(counters.dropped, 90U);
  EXPECT_EQ(datagrams_in_file(), 10U);
}

}  // namespace
}  // namespace rayloc
