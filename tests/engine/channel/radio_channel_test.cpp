#include "engine/channel/radio_channel.h"

#include <vector>

#include <gtest/gtest.h>

#include "engine/channel/csi_frame.h"

namespace rayloc::radio_channel_test {
namespace {

constexpr RadioChannel k5190{5190e6, 40};

TEST(RadioChannel, HopsStayInTheBandAndKeepTheWidth) {
  EXPECT_TRUE(is_hop(k5190, k5190));
  EXPECT_TRUE(is_hop(k5190, {5755e6, 40}));
  EXPECT_TRUE(is_hop({2412e6, 20}, {2472e6, 20}));
  EXPECT_FALSE(is_hop(k5190, {5210e6, 80}));
  EXPECT_FALSE(is_hop(k5190, {2437e6, 40}));
  EXPECT_FALSE(is_hop(k5190, {5965e6, 40})) << "of 6 GHz";
}

TEST(RadioChannel, FramesThatStateNoneAreOfTheGrid) {
  const OfdmGrid grid{5190e6, 312'500.0, {-1, 1}};
  std::vector<CsiFrame> frames(3);
  frames[1].channel = k5190;
  frames[2].channel = RadioChannel{5230e6, 40};
  EXPECT_TRUE(is_on(grid, frames[0]));
  EXPECT_TRUE(is_on(grid, frames[1]));
  EXPECT_FALSE(is_on(grid, frames[2]));
  EXPECT_EQ(frames_on(grid, frames).size(), 2U);
}

}  // namespace
}  // namespace rayloc::radio_channel_test
