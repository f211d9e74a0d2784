#include "engine/track/recent_fixes.h"

#include <gtest/gtest.h>

namespace rayloc::recent_fixes_test {
namespace {

Timestamp at(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }

TEST(RecentFixes, SlopeOfHalfASecondAtLeast) {
  RecentFixes fixes;
  EXPECT_FALSE(fixes.velocity());
  for (int ms = 0; ms < 500; ms += 100) {
    fixes.add(at(ms), {1.0 + 0.5e-3 * ms, 2.0, 1.2});
    EXPECT_FALSE(fixes.velocity()) << ms;
  }
  fixes.add(at(500), {1.25, 2.0, 1.2});
  ASSERT_TRUE(fixes.velocity());
  EXPECT_NEAR(fixes.velocity()->x, 0.5, 1e-9);
  EXPECT_NEAR(fixes.velocity()->y, 0.0, 1e-9);
  fixes.clear();
  EXPECT_FALSE(fixes.velocity());
}

TEST(RecentFixes, OlderThanASecondDoNotCount) {
  RecentFixes fixes;
  for (int ms = 0; ms <= 3000; ms += 100) {
    const double x = ms < 1500 ? 0.0 : 1e-3 * (ms - 1500);
    fixes.add(at(ms), {x, -x, 1.2});
  }
  EXPECT_NEAR(fixes.velocity()->x, 1.0, 1e-9);
  EXPECT_NEAR(fixes.velocity()->y, -1.0, 1e-9);
}

}  // namespace
}  // namespace rayloc::recent_fixes_test
