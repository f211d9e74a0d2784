#include "daemon/lab/experiment/condition.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::condition_test {
namespace {

using ::testing::HasSubstr;

TEST(Condition, DefaultsAreThoseOfTheTable) {
  const Condition condition = default_condition();
  std::set<std::string_view> keys;
  for (const ConditionKey& key : condition_keys()) {
    EXPECT_TRUE(keys.insert(key.key).second) << key.key;
    EXPECT_EQ(condition_text(condition, key.key), key.preset) << key.key;
    if (const auto* number = std::get_if<double Condition::*>(&key.member)) {
      EXPECT_GE(condition.**number, key.range.min) << key.key;
      EXPECT_LE(condition.**number, key.range.max) << key.key;
    }
  }
  EXPECT_EQ(condition_text(condition, "paper.alpha"), "0.2");
  EXPECT_EQ(condition_text(condition, "paper.smoothing"), "true");
}

TEST(Condition, AxesOfChartsAreNumbers) {
  const Condition condition = default_condition();
  EXPECT_EQ(condition_number(condition, "spots"), 20.0);
  EXPECT_EQ(condition_number(condition, "paper.sigma_0_squared"), 1.0);
  EXPECT_FALSE(condition_number(condition, "method"));
  EXPECT_FALSE(condition_number(condition, "paper.smoothing"));
}

TEST(Condition, WorldsDifferOnlyBySimulatedSettings) {
  const Condition one = default_condition();
  Condition other = one;
  other.method = "paper";
  other.repeats = 7;
  other.model_depth = 1;
  other.paper["alpha"] = 9.0;
  EXPECT_EQ(world_text(one), world_text(other));
  other.boxes = 3;
  EXPECT_NE(world_text(one), world_text(other));
}

TEST(Condition, HelpNamesEveryKey) {
  const std::string help = experiment_help();
  EXPECT_THAT(help, HasSubstr("sight = \"any\""));
  EXPECT_THAT(help, HasSubstr("boxes = 0"));
  EXPECT_THAT(help, HasSubstr("paper.sigma_0_squared = 1"));
}

}  // namespace
}  // namespace rayloc::condition_test
