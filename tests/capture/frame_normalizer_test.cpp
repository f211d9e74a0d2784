// Made-up frames through the whole receiver: what comes out must be the channel that went in.
#include "capture/assemble/frame_normalizer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/csi_receiver.h"
#include "engine/channel/tone_plan.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::frame_normalizer_test {
namespace {

using test::Recording;
using test::WireFrame;
using test::WirePhy;

constexpr double kDelay = 93e-9;  // [s]

std::vector<CsiFrame> receive(const Recording& recording, bool raw = false) {
  CsiReceiverOptions options;
  options.raw = raw;
  CsiReceiver receiver(options);
  return test::receive_all(receiver, recording);
}

struct SyntheticCase {
  const char* name;
  WirePhy phy;
  int channel_mhz;
  int occupied_mhz;
  int centre_tone;
  int streams;
  std::size_t datagrams;
  std::size_t tones;  // that come out
  int first_tone;
  int last_tone;
};

class Synthetic : public ::testing::TestWithParam<SyntheticCase> {
 protected:
  WireFrame make() const {
    const SyntheticCase& c = GetParam();
    WireFrame frame;
    frame.phy = c.phy;
    frame.channel_mhz = c.channel_mhz;
    frame.occupied_mhz = c.occupied_mhz;
    frame.centre_tone = c.centre_tone;
    frame.streams = frame.transmitted_streams = c.streams;
    frame.channel = test::delayed_path(kDelay, c.phy == WirePhy::kHe ? 78'125.0 : 312'500.0);
    return frame;
  }
};

TEST_P(Synthetic, DecodesToTheSimulatedChannel) {
  const SyntheticCase& c = GetParam();
  const WireFrame wire = make();
  const Recording recording = test::write_axcsi(wire, Timestamp(std::chrono::seconds(1)));
  EXPECT_EQ(recording.size(), c.datagrams);
  const auto frames = receive(recording);
  ASSERT_EQ(frames.size(), 1U);
  const CsiFrame& frame = frames[0];
  EXPECT_TRUE(frame.complete);
  EXPECT_EQ(static_cast<int>(frame.phy), static_cast<int>(c.phy));
  EXPECT_EQ(frame.bandwidth_mhz, c.occupied_mhz);
  EXPECT_EQ(frame.channel_bandwidth_mhz, c.channel_mhz);
  EXPECT_EQ(frame.transmitted_streams, c.streams);
  EXPECT_EQ(frame.rx_chains.size(), 4U);
  EXPECT_EQ(frame.csi.streams(), static_cast<std::size_t>(c.streams));
  EXPECT_EQ(frame.tone_index.size(), c.tones);
  EXPECT_EQ(frame.tone_index.front(), c.first_tone);
  EXPECT_EQ(frame.tone_index.back(), c.last_tone);
  EXPECT_TRUE(std::is_sorted(frame.tone_index.begin(), frame.tone_index.end()));
  for (int rx_chain = 0; rx_chain < 4; ++rx_chain) {
    for (int stream = 0; stream < c.streams; ++stream) {
      const auto row =
          frame.csi.row(static_cast<std::size_t>(rx_chain), static_cast<std::size_t>(stream));
      for (std::size_t i = 0; i < row.size(); ++i) {
        const auto expected = wire.channel(rx_chain, stream, frame.tone_index[i]);
        // Half a unit of an 11-bit mantissa, in each part.
        ASSERT_LT(std::abs(std::complex<double>(row[i]) - expected), 100.0 / 2048)
            << "core " << rx_chain << " stream " << stream << " tone " << frame.tone_index[i];
      }
    }
  }
}

TEST_P(Synthetic, DelayHasTheDocumentedSign) {
  // h(f) = exp(-j 2 pi f tau): from tone to tone the phase falls by 2 pi spacing tau.
  const auto frames = receive(test::write_axcsi(make(), Timestamp()));
  ASSERT_EQ(frames.size(), 1U);
  const auto row = frames[0].csi.row(2, 0);
  std::complex<double> sum;
  for (std::size_t i = 1; i < row.size(); ++i) {
    if (frames[0].tone_index[i] - frames[0].tone_index[i - 1] == 1) {
      sum += std::complex<double>(row[i] * std::conj(row[i - 1]));
    }
  }
  const double delay = -std::arg(sum) / (2.0 * std::numbers::pi * frames[0].tone_spacing_hz);
  EXPECT_NEAR(delay, kDelay, 0.2e-9);
}

INSTANTIATE_TEST_SUITE_P(
    Frames,
    Synthetic,
    ::testing::Values(
        SyntheticCase{"Legacy20", WirePhy::kLegacy, 20, 20, 0, 1, 4, 52, -26, 26},
        SyntheticCase{"Legacy20In80", WirePhy::kLegacy, 80, 20, 32, 1, 4, 52, 6, 58},
        SyntheticCase{"LegacyDuplicate40", WirePhy::kLegacy, 40, 40, 0, 1, 4, 104, -58, 58},
        SyntheticCase{"LegacyDuplicate80", WirePhy::kLegacy, 80, 80, 0, 1, 4, 208, -122, 122},
        SyntheticCase{"Ht20", WirePhy::kHt, 20, 20, 0, 1, 4, 56, -28, 28},
        SyntheticCase{"Ht40OneStream", WirePhy::kHt, 40, 40, 0, 1, 4, 114, -58, 58},
        SyntheticCase{"Ht40TwoStreams", WirePhy::kHt, 40, 40, 0, 2, 8, 114, -58, 58},
        SyntheticCase{"Vht20", WirePhy::kVht, 20, 20, 0, 1, 4, 56, -28, 28},
        SyntheticCase{"Vht20In40", WirePhy::kVht, 40, 20, -32, 1, 4, 56, -60, -4},
        SyntheticCase{"Vht40", WirePhy::kVht, 40, 40, 0, 1, 4, 114, -58, 58},
        SyntheticCase{"Vht40TwoStreams", WirePhy::kVht, 40, 40, 0, 2, 8, 108, -58, 58},
        SyntheticCase{"Vht40InUpper80", WirePhy::kVht, 80, 40, 64, 1, 4, 114, 6, 122},
        SyntheticCase{"Vht80", WirePhy::kVht, 80, 80, 0, 1, 4, 242, -122, 122},
        SyntheticCase{"Vht80FourStreams", WirePhy::kVht, 80, 80, 0, 4, 16, 234, -122, 122},
        SyntheticCase{"Vht160", WirePhy::kVht, 160, 160, 0, 1, 8, 484, -250, 250},
        SyntheticCase{"Vht160FourStreams", WirePhy::kVht, 160, 160, 0, 4, 32, 468, -250, 250},
        SyntheticCase{"Vht80InLower160", WirePhy::kVht, 160, 80, -128, 1, 8, 242, -250, -6},
        SyntheticCase{"Vht20In160", WirePhy::kVht, 160, 20, 224, 1, 8, 56, 196, 252},
        SyntheticCase{"He20", WirePhy::kHe, 20, 20, 0, 1, 4, 242, -122, 122},
        SyntheticCase{"He40", WirePhy::kHe, 40, 40, 0, 1, 8, 484, -244, 244},
        SyntheticCase{"He80", WirePhy::kHe, 80, 80, 0, 1, 16, 996, -500, 500},
        SyntheticCase{"He80TwoStreams", WirePhy::kHe, 80, 80, 0, 2, 32, 980, -500, 500},
        SyntheticCase{"He160FourStreams", WirePhy::kHe, 160, 160, 0, 4, 128, 1958, -1012, 1011},
        SyntheticCase{"He20In80", WirePhy::kHe, 80, 20, 128, 1, 16, 242, 6, 250}),
    [](const ::testing::TestParamInfo<SyntheticCase>& test) {
      return std::string(test.param.name);
    });

TEST(FrameNormalizer, KeepsTheSoundedTonesOfAShortHeTrainingField) {
  for (const int stride : {2, 4}) {
    WireFrame wire;
    wire.phy = WirePhy::kHe;
    wire.channel_mhz = wire.occupied_mhz = 80;
    wire.training_stride = stride;
    wire.channel = test::delayed_path(kDelay, 78'125.0);
    const auto frames = receive(test::write_axcsi(wire, Timestamp()));
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_THAT(frames[0].flags, ::testing::Contains("sparse_training"));
    EXPECT_THAT(
        frames[0].tone_index,
        ::testing::Each(::testing::Truly([stride](int tone) { return tone % stride == 0; })));
    EXPECT_EQ(frames[0].tone_index.size(), stride == 2 ? 498U : 250U);
  }
}

TEST(FrameNormalizer, RawIsAsOnTheWire) {
  WireFrame wire;
  const auto frames = receive(test::write_axcsi(wire, Timestamp()), /*raw=*/true);
  ASSERT_EQ(frames.size(), 1U);
  const auto expected = test::wire_tones(wire, 3, 0);
  ASSERT_EQ(frames[0].tone_index.size(), 128U);
  EXPECT_EQ(frames[0].tone_index[0], 0);
  EXPECT_EQ(frames[0].tone_index[63], 63);
  EXPECT_EQ(frames[0].tone_index[64], -64);
  for (std::size_t i = 0; i < 128; ++i) {
    EXPECT_LT(std::abs(std::complex<double>(frames[0].csi.row(3, 0)[i]) - expected[i]), 0.2) << i;
  }
}

TEST(FrameNormalizer, NexmonAndUbilocateComeOutTheSame) {
  using test::NexmonChip;
  WireFrame wire;
  wire.channel_mhz = wire.occupied_mhz = 80;
  wire.channel = [](int rx_chain, int stream, int tone) {
    return 8.0 * test::delayed_path(kDelay, 312'500.0)(rx_chain, stream, tone);
  };
  struct Case {
    const char* what;
    Recording recording;
    int lowest_usable;  // of the tones above the centre
    double tolerance;
  };
  const std::array<Case, 5> cases{
      {{"4366c0 v1", test::write_nexmon(wire, NexmonChip::k4366c0, 1, {}), 2, 0.5},
       {"4366c0 v2", test::write_nexmon(wire, NexmonChip::k4366c0, 2, {}), 3, 0.5},
       {"4358 v1", test::write_nexmon(wire, NexmonChip::k4358, 1, {}), 2, 4.0},
       {"43455c0 v2", test::write_nexmon(wire, NexmonChip::k43455c0, 2, {}), 3, 1.0},
       {"ubilocate", test::write_ubilocate(wire, {}), 2, 0.5}}};
  for (const auto& c : cases) {
    const auto frames = receive(c.recording);
    ASSERT_EQ(frames.size(), 1U) << c.what;
    const CsiFrame& frame = frames[0];
    EXPECT_EQ(frame.phy, PhyFormat::kVht) << c.what;
    EXPECT_EQ(frame.bandwidth_mhz, 80) << c.what;
    EXPECT_EQ(*std::upper_bound(frame.tone_index.begin(), frame.tone_index.end(), 0),
              c.lowest_usable)
        << c.what;
    for (std::size_t i = 0; i < frame.tone_index.size(); ++i) {
      ASSERT_LT(std::abs(std::complex<double>(frame.csi.row(1, 0)[i]) -
                         wire.channel(1, 0, frame.tone_index[i])),
                c.tolerance)
          << c.what << " tone " << frame.tone_index[i];
    }
  }
}

TEST(FrameNormalizer, RecognisesLegacyFramesByTheirTones) {
  WireFrame wire;
  wire.phy = WirePhy::kLegacy;
  wire.channel_mhz = 80;
  wire.occupied_mhz = 20;
  wire.centre_tone = -96;
  const auto frames = receive(test::write_nexmon(wire, test::NexmonChip::k4366c0, 1, Timestamp()));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].phy, PhyFormat::kLegacy);
  EXPECT_EQ(frames[0].tone_index.front(), -122);
  EXPECT_EQ(frames[0].tone_index.back(), -70);
}

TEST(FrameNormalizer, MissingToneBlocksLeaveTheirRowOut) {
  WireFrame wire;
  wire.phy = WirePhy::kHe;
  wire.channel_mhz = wire.occupied_mhz = 40;
  wire.channel = test::delayed_path(kDelay, 78'125.0);
  Recording recording = test::write_axcsi(wire, Timestamp());
  recording.erase(recording.begin() + 2);  // the first half of core 1
  const auto frames = receive(recording);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_FALSE(frames[0].complete);
  EXPECT_THAT(frames[0].flags, ::testing::Contains("missing_tones"));
  EXPECT_THAT(frames[0].rx_chains, ::testing::ElementsAre(0, 2, 3));
  EXPECT_EQ(frames[0].csi.tones(), 484U);
}

TEST(FrameNormalizer, WithoutAWholeRowTheCommonTonesRemain) {
  WireFrame wire;
  wire.phy = WirePhy::kHe;
  wire.channel_mhz = wire.occupied_mhz = 40;
  wire.channel = test::delayed_path(kDelay, 78'125.0);
  const Recording whole = test::write_axcsi(wire, Timestamp());
  Recording upper_halves;  // FFT order: the first 256 are the tones from 0 up
  for (std::size_t i = 0; i < whole.size(); i += 2) {
    upper_halves.push_back(whole[i]);
  }
  const auto frames = receive(upper_halves);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_FALSE(frames[0].complete);
  EXPECT_EQ(frames[0].rx_chains.size(), 4U);
  EXPECT_EQ(frames[0].tone_index.front(), 3);
  EXPECT_EQ(frames[0].tone_index.back(), 244);
}

TEST(FrameNormalizer, AChainOfZerosIsFlaggedAndDoesNotDisturb) {
  WireFrame wire;
  wire.channel_mhz = 80;
  wire.occupied_mhz = 20;
  wire.centre_tone = 96;
  Recording recording = test::write_axcsi(wire, Timestamp());
  std::fill(recording[1].payload.begin() + 54, recording[1].payload.end(), std::byte{0});
  const auto frames = receive(recording);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_THAT(frames[0].flags, ::testing::Contains("zero_core"));
  EXPECT_EQ(frames[0].bandwidth_mhz, 20);
  EXPECT_EQ(frames[0].tone_index.front(), 96 - 28);
}

TEST(FrameNormalizer, OnlyZerosGiveTheWholeChannel) {
  Recording recording = test::write_axcsi({}, Timestamp());
  for (auto& datagram : recording) {
    std::fill(datagram.payload.begin() + 54, datagram.payload.end(), std::byte{0});
  }
  const auto frames = receive(recording);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].csi.tones(), 114U);
}

}  // namespace
}  // namespace rayloc::frame_normalizer_test
