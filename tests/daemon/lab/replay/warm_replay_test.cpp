// Tests the refusal of a time or of records from which a replay cannot start.
#include "daemon/lab/replay/warm_replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::replay::warm_replay_test {
namespace {

using ::testing::HasSubstr;

TEST(WarmReplay, StartsAtTheBeginningWithoutOptions) {
  const auto start = warm_start_of({});
  ASSERT_TRUE(start) << start.error().message;
  EXPECT_EQ(start->listen_from, Timestamp::min());
  EXPECT_EQ(start->from, Timestamp::min());
  EXPECT_EQ(start->carried, nullptr);
}

TEST(WarmReplay, RefusesATimeThatIsNone) {
  WarmOptions replay;
  replay.from = "yesterday";
  const auto start = warm_start_of(replay);
  ASSERT_FALSE(start);
  EXPECT_EQ(start.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(start.error().message, HasSubstr("--from yesterday"));
}

TEST(WarmReplay, RefusesWhatItCannotGoOnWith) {
  WarmOptions replay;
  replay.carried = "missing.jsonl";
  const auto missing = warm_start_of(replay);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kBadInput);
  replay.carried = test::data_path("/sites/meeting_room/site.toml");
  const auto record = warm_start_of(replay);
  ASSERT_FALSE(record);
  EXPECT_EQ(record.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(record.error().message, HasSubstr("site.toml:1: no record of --carried-out"));
}

}  // namespace
}  // namespace rayloc::replay::warm_replay_test
