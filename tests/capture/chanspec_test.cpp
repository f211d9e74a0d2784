// The channel that a Broadcom radio states.
#include "capture/decode/chanspec.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "capture/decode/decoder_registry.h"

namespace rayloc::chanspec_test {
namespace {

TEST(Field, AChanspecNamesTheCentreAndTheWidthOfItsChannel) {
  EXPECT_EQ(channel_of_chanspec(0xd024), (RadioChannel{5180e6, 20}));
  EXPECT_EQ(channel_of_chanspec(0xd826), (RadioChannel{5190e6, 40}));
  EXPECT_EQ(channel_of_chanspec(0xd99f), (RadioChannel{5795e6, 40}));
  EXPECT_EQ(channel_of_chanspec(0xe39b), (RadioChannel{5775e6, 80}));
  EXPECT_EQ(channel_of_chanspec(0xe832), (RadioChannel{5250e6, 160}));
  EXPECT_EQ(channel_of_chanspec(0x1006), (RadioChannel{2437e6, 20}));
}

TEST(Field, AChanspecThatIsNoneNamesNoChannel) {
  for (const unsigned junk :
       {0x0000U, 0xffffU, 0x1000U, 0x100eU, 0xd000U, 0xd0ffU, 0xc826U, 0x9826U}) {
    EXPECT_FALSE(channel_of_chanspec(static_cast<std::uint16_t>(junk))) << junk;
  }
}

TEST(Field, EachBroadcomFormatYieldsItsChannel) {
  const RadioChannel channel{5210e6, 80};
  std::vector<std::byte> nexmon(18 + 4 * 256);
  nexmon[0] = nexmon[1] = nexmon[2] = nexmon[3] = std::byte{0x11};
  nexmon[14] = std::byte{0x2a};
  nexmon[15] = std::byte{0xe0};
  const DecoderRegistry registry("");
  EXPECT_EQ(registry.decode(nexmon)->channel, channel);
  nexmon[2] = std::byte{0xc4};  // version 2 has a level there
  EXPECT_EQ(registry.decode(nexmon)->channel, channel);
}

}  // namespace
}  // namespace rayloc::chanspec_test
