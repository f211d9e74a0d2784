#include "daemon/lab/simulate/channel_list.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::channel_list_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr RadioChannel k36At20{5.18e9, 20};
constexpr RadioChannel k36At40{5.19e9, 40};
constexpr RadioChannel k36At80{5.21e9, 80};

// Centres [MHz].
std::vector<int> centres(std::string_view text, const RadioChannel& site) {
  const auto channels = parse_channels(text, site);
  EXPECT_TRUE(channels) << text;
  std::vector<int> all;
  for (const RadioChannel& channel : channels ? *channels : std::vector<RadioChannel>()) {
    EXPECT_EQ(channel.bandwidth_mhz, site.bandwidth_mhz);
    all.push_back(static_cast<int>(std::lround(channel.centre_hz / 1e6)));
  }
  return all;
}

// IEEE 802.11-2020, annex E: 40 MHz about 38, 46, ...; 80 MHz about 42, 58, 106, ...; 160 MHz about
// 50 and 114.
TEST(ChannelList, NamesChannelsOfTheSitesWidthThatHoldTheNumbers) {
  EXPECT_THAT(centres("36", k36At20), ElementsAre(5180));
  EXPECT_THAT(centres("36-48", k36At20), ElementsAre(5180, 5200, 5220, 5240));
  EXPECT_THAT(centres("36", k36At40), ElementsAre(5190));
  EXPECT_THAT(centres("38", k36At40), ElementsAre(5190)) << "its centre";
  EXPECT_THAT(centres("36-64", k36At40), ElementsAre(5190, 5230, 5270, 5310));
  EXPECT_THAT(centres("40-44", k36At40), ElementsAre(5190, 5230));
  EXPECT_THAT(centres("36-64,100-144", k36At80), ElementsAre(5210, 5290, 5530, 5610, 5690));
  EXPECT_THAT(centres("36-177", {5.25e9, 160}), ElementsAre(5250, 5570, 5815));
  EXPECT_THAT(centres("1-13", {2.412e9, 20}).size(), 13U);
}

TEST(ChannelList, IsAscendingAndHasEachChannelOnce) {
  EXPECT_THAT(centres("100,36,36-44,38", k36At40), ElementsAre(5190, 5230, 5510));
}

TEST(ChannelList, HasTheSitesChannelAsItIsStated) {
  const RadioChannel stated{5.1901e9, 40};
  EXPECT_EQ(parse_channels("36-48", stated)->front(), stated);
}

TEST(ChannelList, ReportsInvalidChannelLists) {
  for (const char* text : {"", "36,", "a", "36-", "48-36", "36 - 48", "-36", "36-40-44"}) {
    const auto channels = parse_channels(text, k36At40);
    ASSERT_FALSE(channels) << text;
    EXPECT_THAT(channels.error().message, HasSubstr("36-64,100-144")) << text;
  }
  const auto none = parse_channels("36,70-90", k36At40);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("70-90"));
  EXPECT_FALSE(parse_channels("144", {5.25e9, 160})) << "beyond the last of 160 MHz";
  EXPECT_FALSE(parse_channels("1", {2.422e9, 40}));
  EXPECT_FALSE(parse_channels("37", {6.135e9, 20}));
}

}  // namespace
}  // namespace rayloc::channel_list_test
