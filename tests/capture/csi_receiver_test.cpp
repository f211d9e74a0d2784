// The receiver under everything that a network does to datagrams. Each test also checks that every
// datagram is counted exactly once, after every push (receive_all).
#include "capture/assemble/csi_receiver.h"

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/traffic_classes.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::csi_receiver_test {
namespace {

using test::Recording;
using test::WireFrame;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Not;
using ::testing::Pair;

constexpr auto kGap = std::chrono::milliseconds(50);  // between frames: longer than the time-out
constexpr Timestamp kStart{std::chrono::seconds(1'000)};

void append(Recording& to, const Recording& from) { to.insert(to.end(), from.begin(), from.end()); }

// `count` frames of four cores from sequence `first` on; the sequence wraps around as on the wire.
Recording frames_of(int count, int first, std::uint64_t transmitter = 0x02524c000001) {
  Recording recording;
  for (int i = 0; i < count; ++i) {
    WireFrame frame;
    frame.transmitter = transmitter;
    frame.sequence = static_cast<std::uint16_t>(first + i);
    frame.sequence_control = static_cast<std::uint16_t>((first + i) << 4);
    append(recording, test::write_axcsi(frame, kStart + i * kGap));
  }
  return recording;
}

struct Received {
  std::vector<CsiFrame> frames;
  CsiReceiverCounters counters;
};

Received receive(const Recording& recording, CsiReceiverOptions options = {}) {
  CsiReceiver receiver(std::move(options));
  Received received;
  received.frames = test::receive_all(receiver, recording);
  received.counters = receiver.counters();
  return received;
}

TEST(CsiReceiver, EmitsACompleteFrameAtOnceAfterLearningItsSize) {
  CsiReceiver receiver({});
  std::vector<CsiFrame> frames;
  const Recording recording = frames_of(6, 1);
  for (const auto& datagram : recording) {
    receiver.push(datagram.view(), frames);
  }
  // The first kWarmUpFrames waited for the next; the others came with their last datagram.
  EXPECT_EQ(frames.size(), 6U);
  EXPECT_EQ(receiver.counters().in_flight, 0U);
}

TEST(CsiReceiver, InterleavedTransmittersAreKeptApart) {
  Recording mixed = frames_of(10, 1, 0x02524c000001);
  append(mixed, frames_of(10, 1, 0x02524c000002));  // the same sequence numbers
  std::stable_sort(
      mixed.begin(), mixed.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  // Datagram by datagram in turn.
  for (std::size_t i = 0; i + 8 <= mixed.size(); i += 8) {
    std::swap(mixed[i + 1], mixed[i + 4]);
    std::swap(mixed[i + 3], mixed[i + 6]);
  }
  const Received received = receive(mixed);
  EXPECT_EQ(received.frames.size(), 20U);
  EXPECT_EQ(received.counters.in_frames, 80U);
  EXPECT_EQ(received.counters.partial, 0U);
}

TEST(CsiReceiver, OrderWithinAFrameDoesNotMatter) {
  Recording recording = frames_of(8, 1);
  for (std::size_t i = 0; i < recording.size(); i += 4) {
    const auto begin = recording.begin() + static_cast<std::ptrdiff_t>(i);
    std::reverse(begin, begin + 4);
    std::rotate(begin, begin + static_cast<std::ptrdiff_t>(i / 4 % 4), begin + 4);
  }
  const Received shuffled = receive(recording);
  const Received ordered = receive(frames_of(8, 1));
  ASSERT_EQ(shuffled.frames.size(), ordered.frames.size());
  for (std::size_t i = 0; i < ordered.frames.size(); ++i) {
    EXPECT_TRUE(std::equal(ordered.frames[i].csi.values().begin(),
                           ordered.frames[i].csi.values().end(),
                           shuffled.frames[i].csi.values().begin()));
    EXPECT_EQ(shuffled.frames[i].rx_chains, ordered.frames[i].rx_chains);
  }
}

TEST(CsiReceiver, OrderBetweenFramesDoesNotMatter) {
  Recording recording = frames_of(8, 1);
  for (auto& datagram : recording) {
    datagram.time = kStart;
  }
  std::shuffle(recording.begin(), recording.end(), std::mt19937(7));
  const Received received = receive(recording);
  EXPECT_EQ(received.frames.size(), 8U);
  EXPECT_EQ(received.counters.partial, 0U);
}

TEST(CsiReceiver, DuplicatesAreCountedOnceInAFrame) {
  Recording recording = frames_of(8, 1);
  for (std::size_t i = recording.size(); i-- > 0;) {
    recording.insert(recording.begin() + static_cast<std::ptrdiff_t>(i), recording[i]);
  }
  const Received received = receive(recording);
  EXPECT_EQ(received.frames.size(), 8U);
  EXPECT_EQ(received.counters.duplicates, 32U);
  EXPECT_EQ(received.counters.in_frames, 32U);
}

TEST(CsiReceiver, LossMakesPartialFramesAfterTheTimeOut) {
  Recording recording = frames_of(10, 1);
  recording.erase(recording.begin() + 26);  // core 2 of the seventh frame, four datagrams each
  CsiReceiver receiver({});
  std::vector<CsiFrame> frames;
  for (std::size_t i = 0; i < 4 * 7 - 1; ++i) {
    receiver.push(recording[i].view(), frames);
  }
  EXPECT_EQ(frames.size(), 6U);
  EXPECT_EQ(receiver.counters().in_flight, 3U);
  const Timestamp begun = kStart + 6 * kGap;
  EXPECT_EQ(receiver.safe_time(begun + kGap), begun);
  receiver.advance(begun + std::chrono::milliseconds(20), frames);
  EXPECT_EQ(frames.size(), 6U);  // not yet
  receiver.advance(begun + std::chrono::milliseconds(21), frames);
  ASSERT_EQ(frames.size(), 7U);
  EXPECT_FALSE(frames.back().complete);
  EXPECT_THAT(frames.back().rx_chains, ElementsAre(0, 1, 3));
  EXPECT_THAT(frames.back().flags, Contains("missing_core"));
  EXPECT_EQ(receiver.counters().partial, 1U);
  EXPECT_EQ(receiver.safe_time(begun + kGap), begun + kGap);
}

TEST(CsiReceiver, CountsDatagramsAfterTheirFrameAsLateThenAsDuplicates) {
  Recording recording = frames_of(7, 1);
  const auto lost = recording[23];  // of the sixth frame, four datagrams each
  recording.erase(recording.begin() + 23);
  auto late = lost;
  late.time += std::chrono::milliseconds(60);
  recording.push_back(late);
  recording.push_back(late);
  const Received received = receive(recording);
  EXPECT_EQ(received.counters.late, 1U);
  EXPECT_EQ(received.counters.duplicates, 1U);
  EXPECT_EQ(received.counters.partial, 1U);
}

TEST(CsiReceiver, SequenceNumbersWrapAround) {
  const Received received = receive(frames_of(12, 65530));
  EXPECT_EQ(received.frames.size(), 12U);
  EXPECT_EQ(received.counters.partial, 0U);
  EXPECT_EQ(received.frames[5].sequence, 65535);
  EXPECT_EQ(received.frames[6].sequence, 0);
}

TEST(CsiReceiver, TheSameNumbersLongAfterAreAnotherFrame) {
  Recording recording = frames_of(3, 1);
  Recording again = frames_of(3, 1);  // after 65536 frames, or a restart of the access point
  for (auto& datagram : again) {
    datagram.time += std::chrono::seconds(10);
  }
  append(recording, again);
  const Received received = receive(recording);
  EXPECT_EQ(received.frames.size(), 6U);
  EXPECT_EQ(received.counters.duplicates, 0U);
}

TEST(CsiReceiver, RetriesOfAFrameAreFramesOfTheirOwn) {
  Recording recording;
  for (int i = 0; i < 3; ++i) {
    WireFrame frame;
    frame.sequence = static_cast<std::uint16_t>(100 + i);
    frame.sequence_control = 0x770;
    frame.transmitted_streams = i == 1 ? 2 : 1;  // the rate falls back
    append(recording, test::write_axcsi(frame, kStart + i * std::chrono::microseconds(29)));
  }
  const Received received = receive(recording);
  ASSERT_EQ(received.frames.size(), 3U);
  EXPECT_THAT(received.frames[0].flags, Not(Contains("retry")));
  EXPECT_THAT(received.frames[1].flags, Contains("retry"));
  EXPECT_THAT(received.frames[2].flags, Contains("retry"));
}

TEST(CsiReceiver, WithoutAFrameCounterOtherBytesAreARetry) {
  WireFrame frame;
  frame.rx_chains = {0, 1};
  const Recording first = test::write_nexmon(frame, test::NexmonChip::k4366c0, 1, kStart);
  frame.channel = test::delayed_path(50e-9, 312'500.0);
  const Recording second = test::write_nexmon(
      frame, test::NexmonChip::k4366c0, 1, kStart + std::chrono::milliseconds(1));
  Recording recording = first;
  recording.push_back(first[1]);  // identical bytes
  append(recording, second);
  const Received received = receive(recording);
  ASSERT_EQ(received.frames.size(), 2U);
  EXPECT_EQ(received.counters.duplicates, 1U);
  EXPECT_EQ(received.frames[1].rx_chains.size(), 2U);
  EXPECT_THAT(received.frames[1].flags, Contains("retry"));
}

TEST(CsiReceiver, ExpectedCoresAreWaitedFor) {
  Recording recording = frames_of(8, 1);
  std::erase_if(recording,
                [](const auto& datagram) { return datagram.payload[8] == std::byte{3}; });
  CsiReceiverOptions options;
  EXPECT_EQ(receive(recording, options).counters.partial, 0U);  // learned: there are three
  options.expected_rx_chains = {0, 3};
  const Received received = receive(recording, options);
  EXPECT_EQ(received.counters.partial, 8U);
  EXPECT_THAT(received.frames[0].flags, Contains("missing_core"));
}

TEST(CsiReceiver, ACoreThatIsGoneIsForgotten) {
  Recording recording = frames_of(100, 1);
  std::size_t index = 0;
  std::erase_if(recording, [&index](const auto& datagram) {
    return index++ >= 40 && datagram.payload[8] == std::byte{1};  // from the eleventh on
  });
  const Received received = receive(recording);
  EXPECT_EQ(received.frames.size(), 100U);
  EXPECT_EQ(received.counters.partial, TrafficClasses::kMemoryFrames - 1);
  EXPECT_TRUE(received.frames.back().complete);
}

TEST(CsiReceiver, MasksInTheDatagramNeedNoLearning) {
  WireFrame frame;
  frame.streams = 2;
  const Recording recording = test::write_ubilocate(frame, kStart);
  CsiReceiver receiver({});
  std::vector<CsiFrame> frames;
  for (const auto& datagram : recording) {
    EXPECT_TRUE(frames.empty());
    receiver.push(datagram.view(), frames);
  }
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].complete);
  EXPECT_THAT(frames[0].power_dbm, ElementsAre(-41.F, -42.F, -43.F, -44.F));
}

TEST(CsiReceiver, AHeaderThatContradictsItsFrameIsRejected) {
  Recording recording = frames_of(1, 1);
  recording[2].payload[23] = std::byte{1};  // HT, where the others have VHT
  const Received received = receive(recording);
  EXPECT_THAT(received.counters.rejected, ElementsAre(Pair("frame_mismatch", 1)));
  EXPECT_EQ(received.counters.in_frames, 3U);
}

TEST(CsiReceiver, ManyOpenFramesAreBounded) {
  CsiReceiverOptions options;
  options.max_pending = 16;
  CsiReceiver receiver(options);
  std::vector<CsiFrame> frames;
  for (int i = 0; i < 1000; ++i) {
    WireFrame frame;
    frame.rx_chains = {0};
    frame.transmitter = static_cast<std::uint64_t>(i);  // every one a stranger
    receiver.push(test::write_axcsi(frame, kStart)[0].view(), frames);
    EXPECT_LE(receiver.counters().in_flight, 16U);
    test::expect_conservation(receiver.counters());
  }
  EXPECT_EQ(frames.size(), 1000U - 16U);
}

TEST(CsiReceiver, AClockThatJumpsDoesNotHoldFramesBack) {
  Recording recording = frames_of(3, 1);
  recording[4].time += std::chrono::hours(24 * 365 * 50);  // one stamp is nonsense
  const Received received = receive(recording);
  EXPECT_EQ(received.counters.in_frames + received.counters.late, 12U);
  Recording back = frames_of(6, 1);
  for (std::size_t i = 12; i < back.size(); ++i) {
    back[i].time -= std::chrono::hours(1);  // the clock was set
  }
  EXPECT_EQ(receive(back).counters.partial, 0U);
}

TEST(CsiReceiver, FramesDoNotDependOnHowOftenAdvanceIsCalled) {
  Recording recording = frames_of(30, 1);
  std::mt19937 random(11);
  std::erase_if(recording, [&random](const auto&) { return random() % 10 == 0; });
  const Received implicit = receive(recording);
  CsiReceiver receiver({});
  std::vector<CsiFrame> frames;
  Timestamp now = recording.front().time;
  for (const auto& datagram : recording) {
    for (; now < datagram.time; now += std::chrono::milliseconds(1)) {
      receiver.advance(now, frames);
    }
    receiver.push(datagram.view(), frames);
  }
  receiver.flush(frames);
  ASSERT_EQ(frames.size(), implicit.frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].sequence, implicit.frames[i].sequence);
    EXPECT_EQ(frames[i].rx_chains, implicit.frames[i].rx_chains);
    EXPECT_EQ(frames[i].complete, implicit.frames[i].complete);
  }
}

TEST(CsiReceiver, AWatermarkBehindAFrameDoesNotEndIt) {
  const Recording recording = frames_of(8, 1);
  CsiReceiver receiver({});
  std::vector<CsiFrame> frames;
  for (const auto& datagram : recording) {
    receiver.push(datagram.view(), frames);
    // As a file does that is read in pieces: the watermark leaves room for disorder.
    receiver.advance(datagram.time - std::chrono::milliseconds(100), frames);
  }
  receiver.flush(frames);
  EXPECT_EQ(frames.size(), 8U);
  EXPECT_EQ(receiver.counters().partial, 0U);
}

// A mixture of all formats and damage to it; `seed` is printed when it fails.
Recording hostile_recording(std::uint32_t seed) {
  Recording recording = frames_of(20, 65525);
  append(recording, frames_of(20, 65525, 0x1111aabbccdd));  // begins like nexmon's magic number
  WireFrame wide;
  wide.phy = test::WirePhy::kHe;
  wide.channel_mhz = wide.occupied_mhz = 80;
  wide.streams = wide.transmitted_streams = 2;
  append(recording, test::write_axcsi(wide, kStart));
  append(recording, test::write_ubilocate({}, kStart));
  append(recording, test::write_nexmon({}, test::NexmonChip::k4358, 2, kStart));
  append(recording, test::write_nexmon({}, test::NexmonChip::k43455c0, 1, kStart));
  std::mt19937 random(seed);
  const auto below = [&random](std::size_t limit) { return random() % limit; };
  for (std::size_t i = 0; i < 200; ++i) {
    auto& datagram = recording[below(recording.size())];
    switch (below(5)) {
      case 0:
        datagram.payload.resize(below(datagram.payload.size() + 1));
        break;
      case 1:
        if (!datagram.payload.empty()) {
          // In the header, where it hurts.
          auto& byte = datagram.payload[below(std::min<std::size_t>(60, datagram.payload.size()))];
          byte ^= static_cast<std::byte>(1U << below(8));
        }
        break;
      case 2:
        std::swap(datagram, recording[below(recording.size())]);
        break;
      case 3:
        recording.push_back(recording[below(recording.size())]);
        break;
      default:
        datagram.time += std::chrono::microseconds(below(100'000)) - std::chrono::milliseconds(50);
        break;
    }
  }
  return recording;
}

TEST(CsiReceiver, HostileInputIsAccountedFor) {
  std::map<std::string, std::uint64_t> rejected;
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    CsiReceiverOptions options;
    options.max_pending = 1 + seed % 20;
    options.raw = seed % 2 == 0;
    const Received received = receive(hostile_recording(seed), options);
    for (const auto& [reason, count] : received.counters.rejected) {
      rejected[reason] += count;
    }
    for (const CsiFrame& frame : received.frames) {
      EXPECT_EQ(frame.csi.antennas(), frame.rx_chains.size());
      EXPECT_EQ(frame.csi.tones(), frame.tone_index.size());
      EXPECT_EQ(frame.power_dbm.size(), frame.rx_chains.size());
      EXPECT_GT(frame.csi.values().size(), 0U);
    }
  }
  // The damage was of many kinds, and has its names.
  for (const char* reason : {"too_short",
                             "length_mismatch",
                             "unknown_format",
                             "core_range",
                             "stream_range",
                             "tone_range",
                             "header_mismatch"}) {
    EXPECT_GT(rejected[reason], 0U) << reason;
  }
}

TEST(CsiReceiver, AFixedFormatRefusesTheOthers) {
  CsiReceiverOptions options;
  options.format = "nexmon-v2";
  const Received received = receive(frames_of(2, 1), options);
  EXPECT_EQ(received.counters.in_frames, 0U);
  EXPECT_THAT(received.counters.rejected, ElementsAre(Pair("length_mismatch", 8)));
}

}  // namespace
}  // namespace rayloc::csi_receiver_test
