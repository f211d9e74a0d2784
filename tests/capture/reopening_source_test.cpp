#include "capture/source/reopening_source.h"

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::reopening_source_test {
namespace {

using namespace std::chrono_literals;

// Earlier than the process's clock, so that the watermarks decide.
constexpr Timestamp kLongAgo{std::chrono::sys_days(std::chrono::year(2001) / 1 / 1)};

Error gone() { return {ErrorKind::kUnavailable, "interface eth7: The interface went down"}; }
Error absent() { return {ErrorKind::kUnavailable, "interface eth7: No such device exists"}; }

// A datagram at each read, stamped long ago, until it has been read so often; then the Error.
class MortalSource final : public DatagramSource {
 public:
  explicit MortalSource(int reads) : reads_(reads) {}

  Expected<void> read(DatagramBatch& batch, Duration /*timeout*/) override {
    batch = {};
    if (reads_-- <= 0) {
      return tl::make_unexpected(gone());
    }
    ++counters_.received;
    ++counters_.delivered;
    ++counters_.rejected["not_udp"];
    ++counters_.received;
    batch.datagrams.emplace_back().time = kLongAgo;
    batch.watermark = kLongAgo;
    return {};
  }
  SourceCounters counters() const override { return counters_; }
  std::string description() const override { return "interface eth7"; }

 private:
  int reads_;
  SourceCounters counters_;
};

// Each opening gives a source that can be read that many times, or no source for -1.
class ReopeningSourceTest : public ::testing::Test {
 protected:
  static constexpr int kAbsent = -1;

  std::unique_ptr<ReopeningSource> open(std::deque<int> openings) {
    openings_ = std::move(openings);
    auto source = ReopeningSource::open(
        [this]() -> Expected<std::unique_ptr<DatagramSource>> {
          ++opened_;
          const int reads = openings_.front();
          openings_.pop_front();
          if (reads == kAbsent) {
            return tl::make_unexpected(absent());
          }
          return std::make_unique<MortalSource>(reads);
        },
        [this] { return now_; });
    EXPECT_TRUE(source) << source.error().message;
    return std::move(*source);
  }

  DatagramBatch read(ReopeningSource& source) {
    DatagramBatch batch;
    EXPECT_TRUE(source.read(batch, Duration::zero()));
    EXPECT_FALSE(batch.ended);
    return batch;
  }

  // Reads every half second until it is opened once more; how long that took.
  std::chrono::milliseconds until_opened(ReopeningSource& source) {
    const auto begin = now_;
    for (const int before = opened_; opened_ == before && now_ < begin + 10min;) {
      now_ += 500ms;
      read(source);
    }
    return std::chrono::duration_cast<std::chrono::milliseconds>(now_ - begin);
  }

  std::deque<int> openings_;
  int opened_ = 0;
  ReopeningSource::Time now_{};
};

TEST_F(ReopeningSourceTest, ReportsAFailureOfTheFirstOpening) {
  const auto source = ReopeningSource::open(
      []() -> Expected<std::unique_ptr<DatagramSource>> { return tl::make_unexpected(absent()); });
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().message, absent().message);
}

TEST_F(ReopeningSourceTest, GoesOnWhenItCanBeOpenedAgain) {
  const auto source = open({1, kAbsent, 1000});
  EXPECT_EQ(read(*source).datagrams.size(), 1U);
  EXPECT_EQ(source->trouble(), "");

  EXPECT_TRUE(read(*source).datagrams.empty());
  EXPECT_EQ(source->trouble(), gone().message);
  EXPECT_EQ(source->counters().failures, 1U);
  EXPECT_EQ(source->description(), "interface eth7");
  EXPECT_EQ(until_opened(*source), 1s);
  EXPECT_EQ(source->trouble(), absent().message) << "the latest";
  EXPECT_EQ(until_opened(*source), 2s);
  EXPECT_EQ(source->trouble(), "");

  // Nothing that was counted is forgotten.
  const SourceCounters counters = source->counters();
  EXPECT_EQ(counters.delivered, 2U);
  EXPECT_EQ(counters.received, 4U);
  EXPECT_EQ(counters.rejected.at("not_udp"), 2U);
  EXPECT_EQ(counters.failures, 1U) << "an attempt to open it is none";
}

TEST_F(ReopeningSourceTest, IncreasesTheRetryIntervalUntilItSucceeds) {
  // The first that is opened again lasts for a read only, which is no reason to hurry.
  const auto source =
      open({0, kAbsent, 1, kAbsent, kAbsent, kAbsent, kAbsent, 1000, kAbsent, 1000});
  read(*source);
  EXPECT_EQ(until_opened(*source), 1s);
  EXPECT_EQ(until_opened(*source), 2s);
  read(*source);  // fails
  for (const auto wait : {4s, 8s, 16s, 30s, 30s}) {
    EXPECT_EQ(until_opened(*source), wait);
  }
  EXPECT_EQ(source->trouble(), "");
  now_ += ReopeningSource::kLongestWait;
  while (source->trouble().empty()) {
    read(*source);
  }
  EXPECT_EQ(until_opened(*source), 1s);
}

TEST_F(ReopeningSourceTest, TimeGoesOnMeanwhileAndNeverBack) {
  const auto source = open({1, 1000});
  EXPECT_EQ(read(*source).watermark, kLongAgo);
  const Timestamp closed = read(*source).watermark;
  EXPECT_GT(closed, kLongAgo) << "others would wait for it";
  now_ += 500ms;
  const Timestamp later = read(*source).watermark;
  EXPECT_GE(later, closed);
  now_ += 500ms;
  const DatagramBatch batch = read(*source);
  ASSERT_EQ(batch.datagrams.size(), 1U);
  EXPECT_GE(batch.datagrams[0].time, later);
  EXPECT_GE(batch.watermark, later);
}

}  // namespace
}  // namespace rayloc::reopening_source_test
