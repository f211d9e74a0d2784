#include "capture/transport/address_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::address_range_test {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t ipv4(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return a << 24U | b << 16U | c << 8U | d;
}

bool contains(const std::string& range, std::uint32_t address) {
  const auto parsed = AddressRange::parse(range);
  EXPECT_TRUE(parsed) << parsed.error().message;
  return parsed && parsed->contains(address);
}

TEST(AddressRange, ContainsExactlyTheAddressesInTheRange) {
  EXPECT_TRUE(contains("192.168.1.7", ipv4(192, 168, 1, 7)));
  EXPECT_FALSE(contains("192.168.1.7", ipv4(192, 168, 1, 6)));
  EXPECT_TRUE(contains("192.168.1.0/24", ipv4(192, 168, 1, 255)));
  EXPECT_FALSE(contains("192.168.1.0/24", ipv4(192, 168, 2, 0)));
  EXPECT_TRUE(contains("10.0.0.2/31", ipv4(10, 0, 0, 3)));
  EXPECT_FALSE(contains("10.0.0.2/31", ipv4(10, 0, 0, 1)));
  EXPECT_TRUE(contains("128.0.0.0/1", ipv4(255, 255, 255, 255)));
  EXPECT_FALSE(contains("128.0.0.0/1", ipv4(127, 255, 255, 255)));
  EXPECT_TRUE(contains("0.0.0.0/0", ipv4(1, 2, 3, 4)));
  EXPECT_TRUE(contains("1.2.3.4/32", ipv4(1, 2, 3, 4)));
}

TEST(AddressRange, ReportsInvalidRanges) {
  for (const char* text : {"",
                           "192.168.1",
                           "192.168.1.0/",
                           "192.168.1.0/33",
                           "192.168.1.0/-1",
                           "192.168.1.0/24 ",
                           "192.168.1.0/24/8",
                           "/24",
                           "router",
                           "fd00::/8"}) {
    const auto range = AddressRange::parse(text);
    ASSERT_FALSE(range) << text;
    EXPECT_EQ(range.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(range.error().message, HasSubstr("192.168.1.0/24"));
  }
  const auto inside = AddressRange::parse("192.168.1.7/24");
  ASSERT_FALSE(inside);
  EXPECT_EQ(inside.error().message,
            "'192.168.1.7/24' is an address in a network; write 192.168.1.7 for the one, "
            "192.168.1.0/24 for the other");
}

}  // namespace
}  // namespace rayloc::address_range_test
