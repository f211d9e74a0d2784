#include "daemon/messages/target_names.h"

#include <filesystem>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::target_names_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr MacAddress kDevice{{0x02, 0x52, 0x4c, 0x00, 0x00, 0x01}};
constexpr MacAddress kOther{{0x02, 0x52, 0x4c, 0x00, 0x00, 0x02}};
constexpr Timestamp kNow{1718000000s};
constexpr Timestamp kMidnight{1718064000s};  // 2024-06-11T00:00:00Z

TEST(TargetNames, AreAddressesUnlessHashesAreWanted) {
  TargetNames names;
  EXPECT_EQ(names.text(kDevice, kNow), "02:52:4c:00:00:01");
  EXPECT_FALSE(names.hashed());
}

// By Python: hmac.new(hmac.new(key, b"rayloc target period 19884", "sha256").digest(),
// bytes.fromhex("02524c000001"), "sha256").hexdigest()[:32].
TEST(TargetNames, WithAKeyAreThoseOfAnyImplementation) {
  TargetNames names({.hashed = true, .key = "0123456789abcdef0123456789abcdef"});
  EXPECT_EQ(names.text(kDevice, kNow), "cfd289d81deb501aa23b531c06606c9c");
  EXPECT_EQ(names.text(kDevice, kNow + 24h), "81b9e60789ec951aa62427c70b06cbc1");
  EXPECT_TRUE(names.hashed());
}

TEST(TargetNames, HoldForAPeriodOfEventTimeAndNoLonger) {
  TargetNames names({.hashed = true});
  const std::string today = names.text(kDevice, kNow);
  EXPECT_EQ(names.text(kDevice, kMidnight - 1ns), today);
  const std::string tomorrow = names.text(kDevice, kMidnight);
  EXPECT_NE(tomorrow, today);
  EXPECT_EQ(names.text(kDevice, kNow), today) << "what was late is still the same";
  EXPECT_NE(names.text(kOther, kNow), today);
  EXPECT_NE(names.text(kDevice, Timestamp{-1ns}), names.text(kDevice, Timestamp{}))
      << "before 1970 as well";
}

TEST(TargetNames, AreForgottenWithTheirKeys) {
  TargetNames names({.hashed = true, .period = 1h});
  const std::string first = names.text(kDevice, kNow);
  std::set<std::string> all = {first};
  for (int hour = 1; hour < 20; ++hour) {
    all.insert(names.text(kDevice, kNow + hour * 1h));
  }
  EXPECT_EQ(all.size(), 20U);
  EXPECT_NE(names.text(kDevice, kNow), first);
  TargetNames restarted({.hashed = true, .period = 1h});
  EXPECT_NE(restarted.text(kDevice, kNow + 19h), names.text(kDevice, kNow + 19h));
}

TEST(TargetNames, AKeyIsLongAndOfItsOwnerAlone) {
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / "target_names_test.key";
  std::ofstream(file) << "short\n";
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  EXPECT_THAT(TargetNames::read_key(file).error().message, HasSubstr("32 characters"));
  std::ofstream(file) << std::string(32, 'k') << "\n";
  EXPECT_EQ(*TargetNames::read_key(file), std::string(32, 'k'));
  std::filesystem::permissions(file, std::filesystem::perms(0644));
  EXPECT_THAT(TargetNames::read_key(file).error().message, HasSubstr("chmod 600"));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace rayloc::target_names_test
