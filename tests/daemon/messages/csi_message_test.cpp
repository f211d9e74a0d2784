#include "daemon/messages/csi_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::csi_message_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

CsiFrame frame_of_two_rx_chains() {
  CsiFrame frame;
  frame.time = Timestamp{1718000000s + 5ns};
  frame.format = "axcsi-v4";
  frame.phy = PhyFormat::kVht;
  frame.bandwidth_mhz = 40;
  frame.channel_bandwidth_mhz = 80;
  frame.sequence = 7;
  frame.sequence_control = 112;
  frame.rx_chains = {0, 3};
  frame.tone_index = {-2, 2};
  frame.csi = Csi(2, 1, 2);
  for (std::size_t rx_chain = 0; rx_chain < 2; ++rx_chain) {
    for (std::size_t tone = 0; tone < 2; ++tone) {
      const auto number = static_cast<float>(10 * rx_chain + tone);
      frame.csi.row(rx_chain, 0)[tone] = {number, -number};
    }
  }
  frame.power_dbm = {-40.0F, -50.0F};
  frame.complete = true;
  frame.flags = {"retry"};
  return frame;
}

TEST(CsiMessage, ContainsEveryFieldOfTheFrame) {
  const v1::CsiFrame message = csi_message(frame_of_two_rx_chains(), "ap1", "somebody");
  EXPECT_EQ(message.time().seconds(), 1718000000);
  EXPECT_EQ(message.time().nanos(), 5);
  EXPECT_EQ(message.ap(), "ap1");
  EXPECT_EQ(message.transmitter(), "somebody");
  EXPECT_EQ(message.format(), "axcsi-v4");
  EXPECT_EQ(message.phy(), v1::PHY_FORMAT_VHT);
  EXPECT_EQ(message.bandwidth_mhz(), 40U);
  EXPECT_EQ(message.channel_bandwidth_mhz(), 80U);
  EXPECT_EQ(message.tone_spacing_hz(), 312'500.0);
  EXPECT_EQ(message.sequence(), 7U);
  EXPECT_EQ(message.sequence_control(), 112U);
  EXPECT_THAT(message.cores(), ElementsAre(0U, 3U));
  EXPECT_EQ(message.streams(), 1U);
  EXPECT_THAT(message.tone_index(), ElementsAre(-2, 2));
  EXPECT_THAT(message.csi(), ElementsAre(0.F, -0.F, 1.F, -1.F, 10.F, -10.F, 11.F, -11.F));
  EXPECT_THAT(message.power_dbm(), ElementsAre(-40.F, -50.F));
  EXPECT_TRUE(message.complete());
  EXPECT_THAT(message.flags(), ElementsAre("retry"));
}

TEST(CsiMessage, StatesPowerOnlyWhenAllOfItIsKnown) {
  CsiFrame frame = frame_of_two_rx_chains();
  frame.power_dbm[1].reset();
  EXPECT_TRUE(csi_message(frame, "ap1", "x").power_dbm().empty());
}

}  // namespace
}  // namespace rayloc::csi_message_test
