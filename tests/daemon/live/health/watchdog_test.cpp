#include "daemon/live/health/watchdog.h"

#include <gtest/gtest.h>

namespace rayloc::watchdog_test {
namespace {

using std::chrono::milliseconds;

TEST(Watchdog, ReportsOnlyTheBlockedStage) {
  StageProgress busy;
  StageProgress waiting;
  StageProgress stuck;
  for (StageProgress* stage : {&busy, &waiting, &stuck}) {
    stage->beat();
  }
  waiting.rest();
  Watchdog watchdog({{"busy", &busy}, {"waiting", &waiting}, {"stuck", &stuck}}, milliseconds(100));
  Watchdog::Time now{};
  EXPECT_TRUE(watchdog.check(now).empty());
  std::vector<Watchdog::Stuck> found;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(found.empty()) << "after " << 10 * i << " ms";
    now += milliseconds(10);
    busy.beat();
    found = watchdog.check(now);
  }
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].stage, "stuck");
  EXPECT_EQ(found[0].since, milliseconds(100));
  stuck.beat();
  EXPECT_TRUE(watchdog.check(now + milliseconds(10)).empty());
}

TEST(Watchdog, AStageThatRestsForLongIsFreshWhenItGoesOn) {
  StageProgress stage;
  stage.beat();
  Watchdog watchdog({{"stage", &stage}}, milliseconds(100));
  Watchdog::Time now{};
  EXPECT_TRUE(watchdog.check(now).empty());
  stage.rest();
  EXPECT_TRUE(watchdog.check(now += milliseconds(5000)).empty());
  stage.beat();
  EXPECT_TRUE(watchdog.check(now += milliseconds(1)).empty());
  EXPECT_TRUE(watchdog.check(now += milliseconds(99)).empty());
  EXPECT_EQ(watchdog.check(now += milliseconds(1)).size(), 1U);
}

// Standbys that begin and end again more often than the patience replace the stages each time.
TEST(Watchdog, AStuckStageIsReportedAlthoughOthersComeAndGo) {
  StageProgress stuck;
  StageProgress other;
  StageProgress successor;
  for (StageProgress* stage : {&stuck, &other, &successor}) {
    stage->beat();
  }
  const std::vector<Stage> with_other = {{"stuck", &stuck}, {"other", &other}};
  Watchdog watchdog(with_other, milliseconds(100));
  Watchdog::Time now{};
  EXPECT_TRUE(watchdog.check(now).empty());
  for (int i = 0; i < 9; ++i) {
    watchdog.replace(i % 2 == 0 ? std::vector<Stage>{{"stuck", &stuck}} : with_other);
    EXPECT_TRUE(watchdog.check(now += milliseconds(10)).empty()) << i;
  }
  // The successor of a stage has its name, and other progress; a stage of another name has no past.
  watchdog.replace({{"other", &successor}, {"new", &other}, {"stuck", &stuck}});
  const std::vector<Watchdog::Stuck> found = watchdog.check(now += milliseconds(10));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].stage, "stuck");
  EXPECT_EQ(found[0].since, milliseconds(100));
  EXPECT_EQ(watchdog.check(now += milliseconds(99)).size(), 1U);
  EXPECT_EQ(watchdog.check(now += milliseconds(1)).size(), 3U);
}

}  // namespace
}  // namespace rayloc::watchdog_test
