#include "daemon/pipeline/playback/paced_source.h"

#include <gtest/gtest.h>

namespace rayloc::paced_source_test {
namespace {

using std::chrono::milliseconds;

// Gives all of its datagrams in one batch, as a file would.
class OneBatch : public DatagramSource {
 public:
  explicit OneBatch(std::vector<int> times) : times_(std::move(times)) {}

  Expected<void> read(DatagramBatch& batch, Duration /*timeout*/) override {
    batch.datagrams.clear();
    for (const int ms : times_) {
      Datagram datagram;
      datagram.time = Timestamp(milliseconds(ms));
      batch.datagrams.push_back(datagram);
      batch.watermark = std::max(batch.watermark, datagram.time);
    }
    batch.ended = true;
    return {};
  }
  SourceCounters counters() const override { return {}; }
  std::string description() const override { return "one batch"; }

 private:
  std::vector<int> times_;
};

TEST(PacedSource, GivesEveryDatagramInOrderAndNotBeforeItIsDue) {
  const std::vector<int> times = {1000, 1010, 1030, 1060};
  const auto pace = std::make_shared<Pace>(1.0);
  PacedSource source(std::make_unique<OneBatch>(times), pace);
  DatagramBatch batch;
  std::vector<Timestamp> seen;
  const auto start = std::chrono::steady_clock::now();
  while (!batch.ended) {
    ASSERT_TRUE(source.read(batch, milliseconds(5)).has_value());
    for (const Datagram& datagram : batch.datagrams) {
      seen.push_back(datagram.time);
      EXPECT_GE(std::chrono::steady_clock::now() - start,
                datagram.time - Timestamp(milliseconds(1000)));
    }
    if (seen.size() < times.size()) {
      EXPECT_EQ(batch.watermark, Timestamp(milliseconds(times[seen.size()])));
    }
  }
  ASSERT_EQ(seen.size(), times.size());
  EXPECT_EQ(seen.back(), Timestamp(milliseconds(1060)));
}

TEST(PacedSource, SpeedShortensTheWait) {
  Pace pace(1000.0);
  const std::size_t recording = pace.join();
  const auto origin = pace.due(recording, Timestamp(milliseconds(5000)));
  EXPECT_EQ(pace.due(recording, Timestamp(milliseconds(6000))) - origin, milliseconds(1));
}

// An hour of silence, or a clock that was set: at most the longest gap is waited for.
TEST(Field, APaceDoesNotWaitForAGap) {
  using std::chrono::hours;
  Pace pace(1.0, milliseconds(1000));
  const std::size_t a = pace.join();
  const std::size_t b = pace.join();
  const Timestamp begin(hours(1000));
  const auto origin = pace.due(a, begin);
  // The time of the other recording's next datagram is not available yet.
  EXPECT_EQ(pace.due(a, begin + hours(1)) - origin, hours(1));
  EXPECT_EQ(pace.due(b, begin + milliseconds(500)) - origin, milliseconds(500));
  EXPECT_EQ(pace.due(a, begin + hours(1)) - origin, hours(1));
  // Then both have nothing for an hour: they go on after a second, in step.
  const auto before = Pace::Clock::now();
  const auto next = pace.due(b, begin + hours(2));
  EXPECT_GE(next, before + hours(1));
  EXPECT_LE(next, Pace::Clock::now() + hours(1) + milliseconds(1000));
  EXPECT_EQ(next - pace.due(a, begin + hours(1)), hours(1));
  // A recording that has ended delays no other.
  pace.leave(a);
  const auto alone = pace.due(b, begin + hours(2));
  EXPECT_LE(alone, Pace::Clock::now() + milliseconds(1000));
}

}  // namespace
}  // namespace rayloc::paced_source_test
