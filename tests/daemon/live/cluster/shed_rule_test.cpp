#include "daemon/live/cluster/shed_rule.h"

#include <gtest/gtest.h>

namespace rayloc::shed_rule_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Timestamp kReceived{seconds(1'700'000'000)};
constexpr ShedRule::Time kNow{seconds(1000)};

TEST(ShedRule, UsesTheFirstOfSomeWindows) {
  int used = 0;
  for (int i = 0; i < 800; ++i) {
    const Timestamp time = kReceived + i * milliseconds(8);
    EXPECT_TRUE(is_used(time, 0));
    used += is_used(time, 2) ? 1 : 0;
  }
  EXPECT_EQ(used, 200);
  EXPECT_TRUE(is_used(kReceived, 3));
  EXPECT_FALSE(is_used(kReceived + milliseconds(400), 1));
}

TEST(ShedRule, ChangesByOneAfterItsPatience) {
  ShedRule rule({});
  const Timestamp late = kReceived - seconds(4);
  EXPECT_FALSE(rule.next_level(kReceived, late, 0, kNow));
  EXPECT_FALSE(rule.next_level(kReceived, late, 0, kNow + milliseconds(4900)));
  EXPECT_EQ(rule.next_level(kReceived, late, 0, kNow + seconds(5)), 1U);
  EXPECT_FALSE(rule.next_level(kReceived, late, 1, kNow + seconds(6)));
  EXPECT_EQ(rule.next_level(kReceived, late, 1, kNow + seconds(10)), 2U);
  EXPECT_FALSE(rule.next_level(kReceived, late, kMaxShed, kNow + seconds(20)));
  // Between the two lags nothing changes.
  EXPECT_FALSE(rule.next_level(kReceived, kReceived - seconds(1), 2, kNow + seconds(30)));
  EXPECT_FALSE(rule.next_level(kReceived, kReceived - seconds(1), 2, kNow + seconds(60)));
  EXPECT_FALSE(rule.next_level(kReceived, kReceived, 2, kNow + seconds(61)));
  EXPECT_EQ(rule.next_level(kReceived, kReceived, 2, kNow + seconds(66)), 1U);
  EXPECT_FALSE(rule.next_level(kReceived, kReceived, 0, kNow + seconds(90)));
}

TEST(ShedRule, GivesNoLevelBeforeTheFirstInstant) {
  ShedRule rule({});
  EXPECT_FALSE(rule.next_level(kReceived, Timestamp::min(), 0, kNow));
  EXPECT_FALSE(rule.next_level(Timestamp::min(), kReceived, 0, kNow + seconds(9)));
}

}  // namespace
}  // namespace rayloc::shed_rule_test
