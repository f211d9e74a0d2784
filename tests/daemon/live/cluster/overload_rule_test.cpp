#include "daemon/live/cluster/ownership/overload_rule.h"

#include <gtest/gtest.h>

namespace rayloc::overload_rule_test {
namespace {

using std::chrono::seconds;

constexpr OverloadRule::Time kStart{seconds(1000)};
constexpr double kBusy = 0.9;
constexpr double kIdle = 0.1;

TEST(OverloadRule, OffersTheSiteThatIsLeftOutMostOnceThatHasStayed) {
  OverloadRule rule;
  const std::map<std::string, std::uint32_t> calm = {{"attic", 0}, {"hall", 0}, {"lab", 0}};
  const std::map<std::string, std::uint32_t> late = {{"attic", 0}, {"hall", 1}, {"lab", 3}};
  EXPECT_FALSE(rule.site_to_offer(calm, kBusy, kIdle, kStart));
  const auto behind = kStart + seconds(300);
  EXPECT_FALSE(rule.site_to_offer(late, kBusy, kIdle, behind));
  EXPECT_FALSE(rule.site_to_offer(late, kBusy, kIdle, behind + seconds(19)));
  EXPECT_EQ(rule.site_to_offer(late, kBusy, kIdle, behind + seconds(20)), "lab");
  // Until it can be seen what has changed nothing more is.
  const std::map<std::string, std::uint32_t> left = {{"attic", 0}, {"hall", 1}};
  EXPECT_FALSE(rule.site_to_offer(left, kBusy, kIdle, behind + seconds(79)));
  EXPECT_EQ(rule.site_to_offer(left, kBusy, kIdle, behind + seconds(80)), "hall");
}

TEST(OverloadRule, IgnoresTransientOverload) {
  OverloadRule rule;
  (void)rule.site_to_offer({{"hall", 0}, {"lab", 0}}, kBusy, kIdle, kStart);
  for (int i = 0; i < 100; ++i) {
    const std::uint32_t level = i % 2 == 0 ? 1 : 0;
    const auto now = kStart + seconds(300 + 15 * i);
    EXPECT_FALSE(rule.site_to_offer({{"hall", level}, {"lab", 0}}, kBusy, kIdle, now)) << i;
  }
}

TEST(OverloadRule, OffersASiteOnlyIfAnotherWorkerCanHelp) {
  const std::map<std::string, std::uint32_t> late = {{"hall", 2}, {"lab", 0}};
  const auto asked = [&](const std::map<std::string, std::uint32_t>& levels,
                         double load,
                         std::optional<double> calmest) {
    OverloadRule rule;
    (void)rule.site_to_offer(levels, load, calmest, kStart);
    return rule.site_to_offer(levels, load, calmest, kStart + seconds(300));
  };
  EXPECT_TRUE(asked(late, kBusy, kIdle));
  EXPECT_FALSE(asked(late, kIdle, kIdle)) << "one thread is too slow, wherever it runs";
  EXPECT_FALSE(asked(late, kBusy, std::nullopt)) << "nobody is there";
  EXPECT_FALSE(asked(late, kBusy, 0.5)) << "it is busy as well";
  EXPECT_FALSE(asked({{"hall", 2}}, kBusy, kIdle)) << "the only one";
}

TEST(OverloadRule, ANewSiteIsNotOffered) {
  OverloadRule rule;
  (void)rule.site_to_offer({{"attic", 0}, {"lab", 0}}, kBusy, kIdle, kStart);
  const std::map<std::string, std::uint32_t> all = {{"attic", 0}, {"hall", 3}, {"lab", 1}};
  (void)rule.site_to_offer(all, kBusy, kIdle, kStart + seconds(110));
  EXPECT_EQ(rule.site_to_offer(all, kBusy, kIdle, kStart + seconds(140)), "lab");
  const std::map<std::string, std::uint32_t> left = {{"attic", 0}, {"hall", 3}};
  EXPECT_FALSE(rule.site_to_offer(left, kBusy, kIdle, kStart + seconds(229)));
  EXPECT_EQ(rule.site_to_offer(left, kBusy, kIdle, kStart + seconds(230)), "hall");
}

}  // namespace
}  // namespace rayloc::overload_rule_test
