// Made recordings of each extractor and chip through the whole receiver: how many frames, of what,
// and nothing unaccounted. They are like those of other people that public_captures_test.cpp reads
// where they are at hand.
#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <array>

#include "capture/assemble/csi_receiver.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::recordings_test {
namespace {

using test::NexmonChip;
using test::Recording;
using test::WireFrame;
using test::WirePhy;
using ::testing::Contains;
using ::testing::ElementsAre;

constexpr Timestamp kStart{std::chrono::seconds(1'800'000'000)};
constexpr auto kGap = std::chrono::milliseconds(50);
constexpr int kFrames = 36;

struct Received {
  std::vector<CsiFrame> frames;
  CsiReceiverCounters counters;
};

// kFrames frames that `write` puts on the wire, the sequence going on.
template <typename Write>
Recording repeated(WireFrame frame, const Write& write) {
  Recording recording;
  for (int i = 0; i < kFrames; ++i) {
    frame.sequence = static_cast<std::uint16_t>(543 + i);
    frame.sequence_control = static_cast<std::uint16_t>(frame.sequence << 4);
    const Recording one = write(frame, kStart + i * kGap);
    recording.insert(recording.end(), one.begin(), one.end());
  }
  return recording;
}

Received receive(const Recording& recording) {
  CsiReceiver receiver({});
  Received received;
  received.frames = test::receive_all(receiver, recording);
  received.counters = receiver.counters();
  EXPECT_EQ(received.counters.in_frames, recording.size());
  EXPECT_EQ(received.counters.partial, 0U);
  EXPECT_EQ(received.frames.size(), static_cast<std::size_t>(kFrames));
  return received;
}

TEST(Recordings, AxcsiOfFourCoresAt40Mhz) {
  const Received received = receive(repeated({}, test::write_axcsi));
  EXPECT_EQ(received.counters.received, 4U * kFrames);
  for (const CsiFrame& frame : received.frames) {
    EXPECT_TRUE(frame.complete);
    EXPECT_THAT(frame.rx_chains, ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(frame.phy, PhyFormat::kVht);
    EXPECT_EQ(frame.bandwidth_mhz, 40);
    EXPECT_EQ(frame.tone_index.size(), 114U);
    EXPECT_EQ(frame.format, "axcsi-v4");
  }
  EXPECT_EQ(received.frames[0].sequence, 543);
  EXPECT_THAT(received.frames[0].power_dbm, ElementsAre(-41.F, -42.F, -43.F, -44.F));
}

TEST(Recordings, AxcsiOfTwoCoresAt80MhzWithoutThePilotsOfTwoStreams) {
  WireFrame frame;
  frame.channel_mhz = frame.occupied_mhz = 80;
  frame.rx_chains = {2, 3};
  frame.transmitted_streams = 2;
  for (const CsiFrame& received : receive(repeated(frame, test::write_axcsi)).frames) {
    EXPECT_TRUE(received.complete);
    EXPECT_THAT(received.rx_chains, ElementsAre(2, 3));
    EXPECT_EQ(received.bandwidth_mhz, 80);
    EXPECT_EQ(received.transmitted_streams, 2);
    EXPECT_EQ(received.tone_index.size(), 242U - 8U);
  }
}

TEST(Recordings, AxcsiOf20MhzInTheUpperPartOf80) {
  for (const WirePhy phy : {WirePhy::kLegacy, WirePhy::kVht}) {
    WireFrame frame;
    frame.phy = phy;
    frame.channel_mhz = 80;
    frame.occupied_mhz = 20;
    frame.centre_tone = 96;
    frame.rx_chains = {1};
    const int half = phy == WirePhy::kLegacy ? 26 : 28;
    for (const CsiFrame& received : receive(repeated(frame, test::write_axcsi)).frames) {
      EXPECT_EQ(received.bandwidth_mhz, 20);
      EXPECT_EQ(received.channel_bandwidth_mhz, 80);
      EXPECT_THAT(received.flags, Contains("subband"));
      EXPECT_EQ(received.tone_index.front(), 96 - half);
      EXPECT_EQ(received.tone_index.back(), 96 + half);
    }
  }
}

TEST(Recordings, UbilocateOf4CoresAnd4Streams) {
  WireFrame frame;
  frame.streams = frame.transmitted_streams = 4;
  const Received received = receive(repeated(frame, test::write_ubilocate));
  EXPECT_EQ(received.counters.received, 16U * kFrames);
  for (const CsiFrame& got : received.frames) {
    EXPECT_TRUE(got.complete);
    EXPECT_EQ(got.csi.antennas(), 4U);
    EXPECT_EQ(got.csi.streams(), 4U);
    EXPECT_EQ(got.csi.tones(), 108U);
    EXPECT_EQ(got.bandwidth_mhz, 40);
    EXPECT_EQ(got.phy, PhyFormat::kVht);
    EXPECT_EQ(got.format, "ubilocate");
  }
}

// The energy of the tones shows what the header does not state: a frame of the whole channel, of
// its lowest quarter, and one that is repeated over its lower half.
TEST(Recordings, NexmonOfEveryChipAndVersion) {
  struct Kind {
    WirePhy phy;
    int occupied_mhz;
    int centre_tone;
  };
  const std::array<Kind, 3> kinds{
      {{WirePhy::kVht, 80, 0}, {WirePhy::kLegacy, 20, -96}, {WirePhy::kLegacy, 40, -64}}};
  for (const auto chip :
       {NexmonChip::k4339, NexmonChip::k4358, NexmonChip::k43455c0, NexmonChip::k4366c0}) {
    for (const int version : {1, 2}) {
      for (const auto& kind : kinds) {
        SCOPED_TRACE(::testing::Message() << "chip " << static_cast<int>(chip) << " version "
                                          << version << ", " << kind.occupied_mhz << " MHz");
        WireFrame frame;
        frame.phy = kind.phy;
        frame.channel_mhz = 80;
        frame.occupied_mhz = kind.occupied_mhz;
        frame.centre_tone = kind.centre_tone;
        frame.rx_chains = {0, 1, 2};
        const auto write = [&](const WireFrame& one, Timestamp time) {
          return test::write_nexmon(one, chip, version, time);
        };
        for (const CsiFrame& received : receive(repeated(frame, write)).frames) {
          EXPECT_EQ(received.format, version == 1 ? "nexmon-v1" : "nexmon-v2");
          EXPECT_EQ(static_cast<int>(received.phy), static_cast<int>(kind.phy));
          EXPECT_EQ(received.bandwidth_mhz, kind.occupied_mhz);
          EXPECT_EQ((received.tone_index.front() + received.tone_index.back()) / 2,
                    kind.centre_tone);
        }
      }
    }
  }
}

}  // namespace
}  // namespace rayloc::recordings_test
