#include "daemon/pipeline/burst_collector.h"

#include <map>
#include <utility>

#include <gtest/gtest.h>

namespace rayloc::burst_collector_test {
namespace {

using std::chrono::milliseconds;

CsiFrame frame_at(int ms, std::uint8_t transmitter = 1, std::size_t access_point = 0) {
  CsiFrame frame;
  frame.time = Timestamp(milliseconds(ms));
  frame.transmitter.octets[5] = transmitter;
  frame.access_point = access_point;
  return frame;
}

class BurstCollectorTest : public ::testing::Test {
 protected:
  CollectorOptions options_;
  BurstCollector collector_{options_};
  std::vector<Burst> ended_;
};

TEST_F(BurstCollectorTest, EndsAfterItsLength) {
  for (int ms = 0; ms < 400; ms += 50) {
    collector_.add(frame_at(ms), ended_);
  }
  ASSERT_EQ(ended_.size(), 1U);
  EXPECT_EQ(ended_[0].frames.size(), 4U);  // 0, 50, 100, 150; 200 opens the next
  EXPECT_EQ(collector_.in_flight(), 4U);
  collector_.advance(Timestamp(milliseconds(400)), ended_);
  ASSERT_EQ(ended_.size(), 2U);
  EXPECT_EQ(ended_[1].first, Timestamp(milliseconds(200)));
  EXPECT_EQ(ended_[1].last, Timestamp(milliseconds(350)));
}

TEST_F(BurstCollectorTest, EndsAtAGap) {
  options_.length = milliseconds(2000);
  BurstCollector collector(options_);
  for (const int ms : {0, 249, 600, 700}) {
    collector.add(frame_at(ms), ended_);
  }
  ASSERT_EQ(ended_.size(), 1U);
  EXPECT_EQ(ended_[0].frames.size(), 2U);
}

TEST_F(BurstCollectorTest, KeepsTransmittersApartAndAccessPointsTogether) {
  collector_.add(frame_at(0, 1, 0), ended_);
  collector_.add(frame_at(1, 2, 0), ended_);
  collector_.add(frame_at(2, 1, 1), ended_);
  EXPECT_EQ(collector_.earliest_open(Timestamp(milliseconds(2))), Timestamp(milliseconds(0)));
  collector_.advance(Timestamp(milliseconds(1000)), ended_);
  ASSERT_EQ(ended_.size(), 2U);
  EXPECT_EQ(ended_[0].frames.size(), 2U);
  EXPECT_EQ(ended_[1].frames.size(), 1U);
  EXPECT_EQ(collector_.earliest_open(Timestamp(milliseconds(5))), Timestamp(milliseconds(5)));
}

TEST_F(BurstCollectorTest, ThinsManyFramesEvenlyAndCountsTheRest) {
  options_.max_frames = 8;
  BurstCollector collector(options_);
  for (int ms = 0; ms < 100; ++ms) {
    collector.add(frame_at(ms, 1, 0), ended_);
    if (ms % 25 == 0) {
      collector.add(frame_at(ms, 1, 1), ended_);
    }
  }
  collector.advance(Timestamp(milliseconds(1000)), ended_);
  ASSERT_EQ(ended_.size(), 1U);
  std::vector<Timestamp> first;
  std::size_t second = 0;
  for (const CsiFrame& frame : ended_[0].frames) {
    if (frame.access_point == 0) {
      first.push_back(frame.time);
    } else {
      ++second;
    }
  }
  EXPECT_EQ(second, 4U);  // a slow access point loses nothing to a fast one
  ASSERT_EQ(first.size(), 7U);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i], Timestamp(milliseconds(16 * static_cast<int>(i))));
  }
  EXPECT_EQ(ended_[0].surplus + ended_[0].frames.size(), 104U);
}

// With every second frame of all left out, a device that hops to and fro would stay on one channel.
TEST_F(BurstCollectorTest, ThinsEachChannelOfADeviceThatHops) {
  options_.max_frames = 8;
  BurstCollector collector(options_);
  const RadioChannel one{5190e6, 40};
  const RadioChannel other{5230e6, 40};
  for (int ms = 0; ms < 100; ++ms) {
    CsiFrame frame = frame_at(ms);
    frame.channel = ms % 2 == 0 ? one : other;
    collector.add(std::move(frame), ended_);
  }
  collector.advance(Timestamp(milliseconds(1000)), ended_);
  ASSERT_EQ(ended_.size(), 1U);
  std::map<RadioChannel, int> kept;
  for (const CsiFrame& frame : ended_[0].frames) {
    ++kept[*frame.channel];
  }
  EXPECT_EQ(kept, (std::map<RadioChannel, int>{{one, 7}, {other, 7}}));
  EXPECT_EQ(ended_[0].surplus + ended_[0].frames.size(), 100U);
}

TEST_F(BurstCollectorTest, RefusesTransmittersBeyondTheLimit) {
  options_.max_transmitters = 2;
  BurstCollector collector(options_);
  for (std::uint8_t transmitter = 1; transmitter <= 5; ++transmitter) {
    collector.add(frame_at(0, transmitter), ended_);
  }
  EXPECT_EQ(collector.refused(), 3U);
  EXPECT_EQ(collector.in_flight(), 2U);
}

TEST(Field, BurstCollectorTakesTheWantedBeyondTheLimit) {
  CollectorOptions options;
  options.max_transmitters = 2;
  options.wanted = [](const MacAddress& transmitter) { return transmitter.octets[5] == 5; };
  BurstCollector collector(options);
  std::vector<Burst> ended;
  for (std::uint8_t transmitter = 1; transmitter <= 5; ++transmitter) {
    collector.add(frame_at(0, transmitter), ended);
  }
  EXPECT_EQ(collector.refused(), 2U);
  EXPECT_EQ(collector.open_bursts(), 3U);
}

// "first-last:frames", one a line, by transmitter and time.
std::string lines(const std::vector<Burst>& bursts) {
  std::string text;
  for (const Burst& burst : bursts) {
    const auto ms = [](Timestamp time) { return std::to_string(time.time_since_epoch().count()); };
    text += std::to_string(burst.transmitter.octets[5]) + " " + ms(burst.first) + "-" +
            ms(burst.last) + ":" + std::to_string(burst.frames.size()) + "\n";
  }
  return text;
}

// Frames of three transmitters, with silences shorter and longer than a gap.
std::vector<CsiFrame> irregular_frames() {
  std::vector<CsiFrame> frames;
  for (int ms = 3; ms < 4000; ms += 7) {
    const int speaker = ms * 13 % 29;
    if (speaker < 4 && ms / 500 % 3 != speaker % 3) {
      frames.push_back(frame_at(ms, static_cast<std::uint8_t>(1 + speaker % 3)));
    }
  }
  return frames;
}

// At any moment, a collector that receives the starts of the open bursts and the frames since the
// first of them makes the same bursts as one that was not interrupted.
TEST_F(BurstCollectorTest, BeginsInTheMiddleWithTheStartsOfTheOpenBursts) {
  for (const int length : {200, 1200}) {
    options_.length = milliseconds(length);
    const std::vector<CsiFrame> frames = irregular_frames();
    std::vector<Burst> whole;
    BurstCollector undisturbed(options_);
    for (CsiFrame frame : frames) {
      undisturbed.add(std::move(frame), whole);
    }
    undisturbed.advance(Timestamp::max(), whole);
    ASSERT_GT(whole.size(), 6U);
    for (int ms = 0; ms < 4100; ms += 41) {
      const Timestamp moment{milliseconds(ms)};
      std::vector<Burst> before;
      BurstCollector first(options_);
      for (CsiFrame frame : frames) {
        if (frame.time < moment) {
          first.add(std::move(frame), before);
        }
      }
      first.advance(moment, before);
      const OpenBursts open = first.open_starts(moment);
      BurstCollector successor(options_, open);
      std::vector<Burst> after = before;
      std::size_t over = 0;
      for (CsiFrame frame : frames) {
        if (frame.time >= first.earliest_open(moment) - milliseconds(100)) {
          ++over;
          successor.add(std::move(frame), after);
        }
      }
      successor.advance(Timestamp::max(), after);
      EXPECT_EQ(lines(after), lines(whole)) << ms << " ms, bursts of " << length;
      std::uint64_t made = successor.passed_over();
      for (std::size_t i = before.size(); i < after.size(); ++i) {
        made += after[i].frames.size() + after[i].surplus;
      }
      EXPECT_EQ(made, over) << "a frame is in a burst or passed over";
    }
  }
}

TEST_F(BurstCollectorTest, DropsAnOpenBurstWithoutFrames) {
  const OpenBursts open{Timestamp(milliseconds(100)),
                        {{frame_at(50).transmitter, Timestamp(milliseconds(50)), {}}}};
  BurstCollector collector(options_, open);
  collector.advance(Timestamp(milliseconds(400)), ended_);
  EXPECT_TRUE(ended_.empty());
  EXPECT_EQ(collector.open_bursts(), 0U);
}

}  // namespace
}  // namespace rayloc::burst_collector_test
