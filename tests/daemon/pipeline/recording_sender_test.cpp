#include "daemon/pipeline/playback/recording_sender.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::recording_sender_test {
namespace {

using std::chrono::milliseconds;

// A recording with datagrams at these milliseconds; each payload is one byte, `mark`.
class MarkedRecording : public DatagramSource {
 public:
  MarkedRecording(std::vector<int> times, char mark)
      : times_(std::move(times)), payload_{static_cast<std::byte>(mark)} {}

  Expected<void> read(DatagramBatch& batch, Duration /*timeout*/) override {
    batch = {};
    for (const int ms : times_) {
      batch.datagrams.push_back({Timestamp(milliseconds(ms)), {}, payload_});
    }
    batch.ended = true;
    return {};
  }
  SourceCounters counters() const override {
    SourceCounters counters;
    counters.rejected["not_udp"] = 2;
    return counters;
  }
  std::string description() const override { return "marked"; }
  std::vector<std::string> warnings() const override { return {"torn"}; }

 private:
  std::vector<int> times_;
  std::array<std::byte, 1> payload_;
};

// Appends a letter for each datagram to a text.
class Letters : public DatagramSink {
 public:
  explicit Letters(std::string* to) : to_(to) {}

  Expected<void> write(const DatagramBatch& batch) override {
    for (const Datagram& datagram : batch.datagrams) {
      *to_ += static_cast<char>(datagram.payload.front());
      ++counters_.given;
      ++counters_.delivered;
    }
    return {};
  }
  Expected<void> sync() override { return {}; }
  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override { return "letters"; }

 private:
  std::string* to_;
  SinkCounters counters_;
};

const std::array<std::string, 2> kAllSent = {"aaa", "bb"};

class RecordingSenderTest : public ::testing::Test {
 protected:
  MergedRecordings recordings() {
    std::vector<std::unique_ptr<DatagramSource>> sources;
    sources.push_back(std::make_unique<MarkedRecording>(std::vector<int>{1000, 1010, 61'010}, 'a'));
    sources.push_back(std::make_unique<MarkedRecording>(std::vector<int>{1005, 61'015}, 'b'));
    return {std::move(sources), [this] { return is_stopped_; }};
  }
  SinkQueue sinks() {
    std::vector<std::unique_ptr<DatagramSink>> all;
    all.push_back(std::make_unique<Letters>(&sent_[0]));
    all.push_back(std::make_unique<Letters>(&sent_[1]));
    return SinkQueue(std::move(all));
  }
  RecordingSender sender(MergedRecordings& from, SinkQueue& to) {
    SendObserver observer;
    observer.on_start = [this](std::optional<Duration> offset) { starts_.push_back(offset); };
    observer.on_gap = [this](Duration gap, Duration skipped, std::optional<Duration> offset) {
      gap_ = gap;
      skipped_ = skipped;
      gap_offset_ = offset;
    };
    return {from, to, observer, [this] { return is_stopped_; }};
  }

  bool is_stopped_ = false;
  std::array<std::string, 2> sent_;  // by sink
  std::vector<std::optional<Duration>> starts_;
  std::optional<Duration> gap_;
  std::optional<Duration> skipped_;
  std::optional<Duration> gap_offset_;
};

TEST_F(RecordingSenderTest, RecordingsAreMergedByTime) {
  MergedRecordings from = recordings();
  std::vector<std::size_t> order;
  for (auto next = from.next(); next && next->datagram != nullptr; next = from.next()) {
    order.push_back(next->recording);
  }
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 0, 0, 1}));
}

TEST_F(RecordingSenderTest, SkipsALongGap) {
  MergedRecordings from = recordings();
  SinkQueue to = sinks();
  const auto outcome = sender(from, to).send_paced({.max_gap = milliseconds(20)});
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(sent_, kAllSent);
  EXPECT_GE(outcome->elapsed, milliseconds(35));
  ASSERT_EQ(starts_.size(), 1U);
  ASSERT_TRUE(starts_.front());
  EXPECT_EQ(gap_, Duration(milliseconds(60'000)));
  EXPECT_EQ(skipped_, Duration(milliseconds(59'980)));
  ASSERT_TRUE(gap_offset_);
  EXPECT_EQ(*gap_offset_, *starts_.front() - *skipped_);
  EXPECT_EQ(from.rejected().at("not_udp"), 4U);
  EXPECT_EQ(from.warnings(), (std::vector<std::string>{"torn", "torn"}));
}

TEST_F(RecordingSenderTest, AnotherSpeedHasNoOffset) {
  MergedRecordings from = recordings();
  SinkQueue to = sinks();
  const auto outcome =
      sender(from, to).send_paced({.speed = std::numeric_limits<double>::infinity()});
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(sent_, kAllSent);
  EXPECT_EQ(starts_, std::vector<std::optional<Duration>>{std::nullopt});
  EXPECT_EQ(gap_, std::nullopt);
  EXPECT_EQ(outcome->latest, Duration{});
}

TEST_F(RecordingSenderTest, ARateRepeatsTheRecordingsUntilTheDurationEnds) {
  MergedRecordings from = recordings();
  SinkQueue to = sinks();
  const auto outcome = sender(from, to).send_at_rate(1000.0, 0.012);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(sent_[0].substr(0, 1), "a");
  EXPECT_GE(to.counters().delivered, 1U);
  EXPECT_LE(to.counters().delivered, 12U);
  EXPECT_EQ(starts_, std::vector<std::optional<Duration>>{std::nullopt});
}

TEST_F(RecordingSenderTest, SendsNothingOnceItIsStopped) {
  is_stopped_ = true;
  MergedRecordings from = recordings();
  SinkQueue to = sinks();
  ASSERT_TRUE(sender(from, to).send_paced({}));
  EXPECT_EQ(sent_, (std::array<std::string, 2>{}));
  EXPECT_EQ(starts_.size(), 1U);
}

}  // namespace
}  // namespace rayloc::recording_sender_test
