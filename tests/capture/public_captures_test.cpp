// Other people's recordings through the whole receiver: how many frames, of what, and nothing
// unaccounted.
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/csi_receiver.h"
#include "engine/base/constants.h"
#include "tests/support/public_captures.h"

namespace rayloc::public_captures_test {
namespace {

using test::PublicCaptures;
using ::testing::ElementsAre;

struct Received {
  std::vector<CsiFrame> frames;
  CsiReceiverCounters counters;
};

Received receive(const std::string& name, CsiReceiverOptions options = {}) {
  CsiReceiver receiver(std::move(options));
  Received received;
  received.frames = test::receive_all(receiver, test::read_public_capture(name));
  received.counters = receiver.counters();
  return received;
}

std::size_t position_of(const CsiFrame& frame, int tone) {
  const auto found = std::find(frame.tone_index.begin(), frame.tone_index.end(), tone);
  EXPECT_NE(found, frame.tone_index.end()) << tone;
  return static_cast<std::size_t>(found - frame.tone_index.begin());
}

// Mean phase from one tone to the next, over pairs of neighbours [radians].
double slope_of(const CsiFrame& frame, std::span<const std::complex<float>> row) {
  std::complex<double> sum;
  for (std::size_t i = 1; i < row.size(); ++i) {
    if (frame.tone_index[i] - frame.tone_index[i - 1] == 1) {
      sum += std::complex<double>(row[i] * std::conj(row[i - 1]));
    }
  }
  return std::arg(sum);
}

// Phase by which the tones `above` are ahead of the tones `below`, the slope taken out: circular
// mean over all frames and cores [degrees].
double mean_step_deg(const std::vector<CsiFrame>& frames, int below, int above) {
  std::complex<double> sum;
  for (const CsiFrame& frame : frames) {
    const std::size_t low = position_of(frame, below);
    const std::size_t high = position_of(frame, above);
    for (std::size_t rx_chain = 0; rx_chain < frame.rx_chains.size(); ++rx_chain) {
      const auto row = frame.csi.row(rx_chain, 0);
      const double step = std::arg(std::complex<double>(row[high] * std::conj(row[low])));
      sum += std::polar(1.0, step - slope_of(frame, row) * (above - below));
    }
  }
  return std::arg(sum) * kDegreesPerRadian;
}

TEST_F(PublicCaptures, AllDataIs36FramesOfFourCores) {
  const Received received = receive("axcsi-rt-ax86u/AllData.pcap");
  EXPECT_EQ(received.counters.received, 144U);
  EXPECT_EQ(received.counters.in_frames, 144U);
  EXPECT_EQ(received.counters.partial, 0U);
  ASSERT_EQ(received.frames.size(), 36U);
  for (const CsiFrame& frame : received.frames) {
    EXPECT_TRUE(frame.complete);
    EXPECT_THAT(frame.rx_chains, ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(frame.phy, PhyFormat::kVht);
    EXPECT_EQ(frame.bandwidth_mhz, 40);
    EXPECT_EQ(frame.channel_bandwidth_mhz, 40);
    EXPECT_EQ(frame.tone_index.front(), -58);
    EXPECT_EQ(frame.tone_index.back(), 58);
    EXPECT_EQ(frame.tone_index.size(), frame.transmitted_streams == 1 ? 114U : 108U);
    EXPECT_EQ(frame.format, "axcsi-v4");
  }
  EXPECT_EQ(to_string(received.frames[0].transmitter), "90:78:b2:b8:36:d5");
  EXPECT_EQ(received.frames[0].sequence, 543);
  EXPECT_THAT(received.frames[0].power_dbm, ElementsAre(-43.F, -54.F, -48.F, -48.F));
}

TEST_F(PublicCaptures, ExtremeIs41FramesOfTwoCoresAt80Mhz) {
  const Received received = receive("axcsi-rt-ax86u/extreme.pcap");
  EXPECT_EQ(received.counters.received, 82U);
  EXPECT_EQ(received.counters.in_frames, 82U);
  ASSERT_EQ(received.frames.size(), 41U);
  for (const CsiFrame& frame : received.frames) {
    EXPECT_TRUE(frame.complete);
    EXPECT_THAT(frame.rx_chains, ElementsAre(2, 3));
    EXPECT_EQ(frame.bandwidth_mhz, 80);
    EXPECT_EQ(frame.transmitted_streams, 2);
    EXPECT_EQ(frame.tone_index.size(), 242U - 8U);  // without pilots: two streams
  }
}

TEST_F(PublicCaptures, MiddleIs20MhzInTheUpperPartOf80) {
  const Received received = receive("axcsi-rt-ax86u/middle.pcap");
  EXPECT_EQ(received.counters.in_frames, 585U);
  ASSERT_EQ(received.frames.size(), 585U);
  int legacy = 0;
  for (const CsiFrame& frame : received.frames) {
    EXPECT_TRUE(frame.complete);
    EXPECT_EQ(frame.bandwidth_mhz, 20);
    EXPECT_EQ(frame.channel_bandwidth_mhz, 80);
    EXPECT_THAT(frame.flags, ::testing::Contains("subband"));
    const int half = frame.phy == PhyFormat::kLegacy ? 26 : 28;
    EXPECT_EQ(frame.tone_index.front(), 96 - half);
    EXPECT_EQ(frame.tone_index.back(), 96 + half);
    legacy += frame.phy == PhyFormat::kLegacy ? 1 : 0;
  }
  EXPECT_EQ(legacy, 262);  // by the rate words
  const auto retries =
      std::count_if(received.frames.begin(), received.frames.end(), [](const CsiFrame& frame) {
        return std::count(frame.flags.begin(), frame.flags.end(), "retry") > 0;
      });
  EXPECT_EQ(retries, 359);
}

TEST_F(PublicCaptures, RotationOf80MhzIsGone) {
  const Received received = receive("axcsi-rt-ax86u/extreme.pcap");
  EXPECT_LT(std::abs(mean_step_deg(received.frames, -65, -64)), 5.0);
}

TEST_F(PublicCaptures, RotationOf40MhzIsGone) {
  const Received received = receive("axcsi-rt-ax86u/AllData.pcap");
  EXPECT_LT(std::abs(mean_step_deg(received.frames, -2, 2)), 25.0);
}

TEST_F(PublicCaptures, ApparentDelayIsPositive) {
  for (const char* name : {"axcsi-rt-ax86u/AllData.pcap", "axcsi-rt-ax86u/extreme.pcap"}) {
    for (const CsiFrame& frame : receive(name).frames) {
      const double delay =
          -slope_of(frame, frame.csi.row(0, 0)) / (2.0 * std::numbers::pi * frame.tone_spacing_hz);
      EXPECT_GT(delay, 30e-9) << name;
      EXPECT_LT(delay, 700e-9) << name;
    }
  }
}

TEST_F(PublicCaptures, UbilocateIs99FramesOf4CoresAnd4Streams) {
  const Received received = receive("ubilocate-rt-ac86u/test_ch_bw_trace4.pcap");
  EXPECT_EQ(received.counters.received, 1584U);
  EXPECT_EQ(received.counters.in_frames, 1584U);
  ASSERT_EQ(received.frames.size(), 99U);
  for (const CsiFrame& frame : received.frames) {
    EXPECT_TRUE(frame.complete);
    EXPECT_EQ(frame.csi.antennas(), 4U);
    EXPECT_EQ(frame.csi.streams(), 4U);
    EXPECT_EQ(frame.csi.tones(), 108U);
    EXPECT_EQ(frame.bandwidth_mhz, 40);
    EXPECT_EQ(frame.phy, PhyFormat::kVht);
  }
  EXPECT_THAT(received.frames[0].power_dbm, ElementsAre(-53.F, -48.F, -45.F, -48.F));
  EXPECT_LT(std::abs(mean_step_deg(received.frames, -2, 2)), 60.0);
}

struct NexmonCase {
  const char* name;
  std::size_t datagrams;
  std::size_t frames;
  const char* format;
};

TEST_F(PublicCaptures, EveryNexmonDatagramIsInAFrame) {
  for (const NexmonCase& c : {NexmonCase{"example_4339.pcap", 2850, 950, "nexmon-v1"},
                              NexmonCase{"example_4366c0.pcap", 293, 293, "nexmon-v1"},
                              NexmonCase{"example_43455c0.pcap", 566, 566, "nexmon-v2"},
                              NexmonCase{"example_4358.pcap", 4, 1, "nexmon-v1"}}) {
    const Received received = receive(std::string("nexmon-csikit/") + c.name);
    EXPECT_EQ(received.counters.received, c.datagrams) << c.name;
    EXPECT_EQ(received.counters.in_frames, c.datagrams) << c.name;
    EXPECT_EQ(received.frames.size(), c.frames) << c.name;
    EXPECT_EQ(received.counters.partial, 0U) << c.name;
    for (const CsiFrame& frame : received.frames) {
      EXPECT_EQ(frame.format, c.format);
    }
  }
}

std::map<std::string, int> kinds_of(const std::vector<CsiFrame>& frames) {
  std::map<std::string, int> kinds;
  for (const CsiFrame& frame : frames) {
    ++kinds[std::string(to_string(frame.phy)) + " " + std::to_string(frame.bandwidth_mhz) + " at " +
            std::to_string((frame.tone_index.front() + frame.tone_index.back()) / 2)];
  }
  return kinds;
}

TEST_F(PublicCaptures, NexmonOccupancyIsFoundByEnergy) {
  using ::testing::Pair;
  // Legacy 20 MHz on the lowest part of 80 MHz, as the chanspec's primary channel states.
  EXPECT_THAT(kinds_of(receive("nexmon-csikit/example_4366c0.pcap").frames),
              ElementsAre(Pair("legacy 20 at -96", 293)));
  // Control frames, duplicated over the lower 40 MHz.
  EXPECT_THAT(kinds_of(receive("nexmon-csikit/example_43455c0.pcap").frames),
              ElementsAre(Pair("legacy 40 at -64", 566)));
  // In one of the 950 frames the upper parts are 10 to 14 dB below the lowest and 19 dB above the
  // guard tones, in all others 18 dB or more below: that one is not clear.
  EXPECT_THAT(kinds_of(receive("nexmon-csikit/example_4339.pcap").frames),
              ElementsAre(Pair("legacy 20 at -96", 949), Pair("legacy 80 at 0", 1)));
  EXPECT_THAT(kinds_of(receive("nexmon-csikit/example_4358.pcap").frames),
              ElementsAre(Pair("vht 80 at 0", 1)));
}

}  // namespace
}  // namespace rayloc::public_captures_test
