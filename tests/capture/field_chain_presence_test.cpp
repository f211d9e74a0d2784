// Receive chains without any further datagrams, and chains whose datagrams are lost in part.
#include <algorithm>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/chain_presence.h"
#include "capture/assemble/csi_receiver.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::field_chain_presence_test {
namespace {

using ::testing::Contains;

constexpr int kFrames = 100;

// Receives frames of the cores 0, 2 and 3, except the datagrams for which is_lost(frame, core).
template <typename Lost>
std::vector<CsiFrame> receive(Lost is_lost, CsiReceiverCounters* counters = nullptr) {
  CsiReceiverOptions options;
  options.expected_rx_chains = {0, 2, 3};
  CsiReceiver receiver(options);
  std::vector<CsiFrame> frames;
  for (int i = 0; i < kFrames; ++i) {
    test::WireFrame frame;
    frame.rx_chains.clear();
    for (const int rx_chain : {0, 2, 3}) {
      if (!is_lost(i, rx_chain)) {
        frame.rx_chains.push_back(rx_chain);
      }
    }
    frame.sequence = static_cast<std::uint16_t>(i);
    const Timestamp time =
        Timestamp(std::chrono::seconds(1'000)) + i * std::chrono::milliseconds(50);
    for (const auto& datagram : test::write_axcsi(frame, time)) {
      receiver.push(datagram.view(), frames);
    }
  }
  receiver.flush(frames);
  if (counters != nullptr) {
    *counters = receiver.counters();
  }
  return frames;
}

std::size_t flagged(const std::vector<CsiFrame>& frames) {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const CsiFrame& frame) {
        return std::find(frame.flags.begin(), frame.flags.end(), ChainPresence::kFlag) !=
               frame.flags.end();
      }));
}

TEST(Field, ChainThatNoFrameHasIsFlaggedAndCounted) {
  CsiReceiverCounters counters;
  const auto frames = receive([](int, int rx_chain) { return rx_chain == 2; }, &counters);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(flagged(frames), kFrames - ChainPresence::kFrames + 1);
  EXPECT_EQ(counters.without_rx_chain.at(2), static_cast<std::uint64_t>(kFrames));
  EXPECT_EQ(counters.without_rx_chain.count(0), 0U);
}

TEST(Field, ChainThatComesBackIsFlaggedNoMore) {
  const auto frames = receive([](int frame, int rx_chain) { return rx_chain == 3 && frame < 50; });
  EXPECT_EQ(flagged(frames), 50 - ChainPresence::kFrames + 1);
  EXPECT_THAT(frames[49].flags, Contains(ChainPresence::kFlag));
  EXPECT_THAT(frames[50].flags, ::testing::Not(Contains(ChainPresence::kFlag)));
}

TEST(Field, LossOfAThirdOfTheDatagramsMakesNoChainDead) {
  std::mt19937 random(1);
  std::bernoulli_distribution lost(0.33);
  EXPECT_EQ(flagged(receive([&](int, int) { return lost(random); })), 0U);
}

// Frames of addresses that no device has.
std::map<std::string, std::uint64_t> rejected_of(std::uint64_t transmitter,
                                                 CsiReceiverOptions options) {
  CsiReceiver receiver(std::move(options));
  std::vector<CsiFrame> frames;
  test::WireFrame frame;
  frame.transmitter = transmitter;
  for (const auto& datagram : test::write_axcsi(frame, Timestamp(std::chrono::seconds(1'000)))) {
    receiver.push(datagram.view(), frames);
  }
  receiver.flush(frames);
  const CsiReceiverCounters counters = receiver.counters();
  EXPECT_EQ(counters.received, 4U);
  EXPECT_EQ(frames.empty(), !counters.rejected.empty());
  return counters.rejected;
}

TEST(Field, GroupAndZeroAddressesAreNoDevices) {
  CsiReceiverOptions options;
  options.only_devices = true;
  using Rejected = std::map<std::string, std::uint64_t>;
  EXPECT_EQ(rejected_of(0xffffffffffff, options), (Rejected{{"group_address", 4}}));
  EXPECT_EQ(rejected_of(0x01005e0000fb, options), (Rejected{{"group_address", 4}}));
  EXPECT_EQ(rejected_of(0x333300000001, options), (Rejected{{"group_address", 4}}));
  EXPECT_EQ(rejected_of(0x000000000000, options), (Rejected{{"zero_address", 4}}));
  EXPECT_EQ(rejected_of(0x02524c000001, options), Rejected()) << "locally administered";
  EXPECT_EQ(rejected_of(0x9078b2b836d5, options), Rejected());
}

// Extractors are tried with made-up frames: 11:22:33:44:55:66 in example_4339.
TEST(Field, GroupAddressThatTheSiteStatesIsTaken) {
  CsiReceiverOptions options;
  options.only_devices = true;
  options.stated_transmitters = {*parse_mac_address("11:22:33:44:55:66")};
  EXPECT_TRUE(rejected_of(0x112233445566, options).empty());
  EXPECT_TRUE(rejected_of(0x112233445566, {}).empty()) << "without a site all are listed";
}

}  // namespace
}  // namespace rayloc::field_chain_presence_test
