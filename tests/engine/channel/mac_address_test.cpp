#include "engine/channel/mac_address.h"

#include <gtest/gtest.h>

namespace rayloc::mac_address_test {
namespace {

TEST(MacAddress, PrintsAParsedAddress) {
  const auto mac = parse_mac_address("02:52:4C:00:00:fe");
  ASSERT_TRUE(mac.has_value());
  EXPECT_EQ(to_string(*mac), "02:52:4c:00:00:fe");
  EXPECT_EQ(parse_mac_address("02-52-4c-00-00-fe").value(), *mac);
}

TEST(MacAddress, RefusesInvalidAddresses) {
  for (const char* text : {"",
                           "02:52:4c:00:00",
                           "02:52:4c:00:00:0",
                           "02:52:4c:00:00:0g",
                           "02.52.4c.00.00.01",
                           "02:52:4c:00:00:012",
                           "+2:52:4c:00:00:01"}) {
    const auto mac = parse_mac_address(text);
    ASSERT_FALSE(mac.has_value()) << text;
    EXPECT_NE(mac.error().message.find("six hexadecimal pairs"), std::string::npos);
  }
}

}  // namespace
}  // namespace rayloc::mac_address_test
