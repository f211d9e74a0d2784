#include "daemon/live/health/saturation.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/health/loss_watch.h"
#include "daemon/live/health/readiness.h"

namespace rayloc::saturation_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Saturation::Time kStart{1000s};
constexpr const char* kFrames =
    "source ap1: frames were dropped in the last 10 s: estimates take longer than frames to come";

TEST(Saturation, HoldsForTenSecondsAfterTheLastLoss) {
  Saturation saturation;
  v1::Heartbeat heartbeat;
  heartbeat.add_sources()->set_access_point("ap1");
  saturation.check(heartbeat, kStart);
  EXPECT_THAT(saturation.reasons(), IsEmpty());
  for (int second = 1; second < 5; ++second) {
    heartbeat.mutable_sources(0)->mutable_counters()->set_frames_dropped(
        static_cast<std::uint64_t>(second));
    saturation.check(heartbeat, kStart + second * 1s);
    EXPECT_THAT(saturation.reasons(), ElementsAre(kFrames));
  }
  saturation.check(heartbeat, kStart + 13s);
  EXPECT_THAT(saturation.reasons(), ElementsAre(kFrames));
  saturation.check(heartbeat, kStart + 14s);
  EXPECT_THAT(saturation.reasons(), IsEmpty()) << "what was lost is over";
}

TEST(Saturation, EveryQueueHasItsReason) {
  Saturation saturation;
  v1::Heartbeat heartbeat;
  v1::SourceReport& source = *heartbeat.add_sources();
  source.set_access_point("ap1");
  source.mutable_counters()->set_kernel_drops(1);
  source.mutable_counters()->set_ring_dropped(1);
  source.mutable_counters()->set_frames_dropped(1);
  heartbeat.mutable_estimation()->set_events_dropped(1);
  heartbeat.mutable_publisher()->set_csi_dropped(1);
  saturation.check(heartbeat, kStart);
  EXPECT_EQ(saturation.reasons().size(), 5U);
}

TEST(Readiness, ASaturatedQueueIsAReason) {
  ServiceHealth health;
  health.saturated = {kFrames};
  const Readiness result = readiness({}, health);
  EXPECT_FALSE(result.ready());
  EXPECT_THAT(result.reasons, ElementsAre(kFrames));
}

TEST(Field, MergedBurstsCauseAWarningWithARemedy) {
  Saturation saturation;
  v1::Heartbeat heartbeat;
  saturation.check(heartbeat, kStart);
  EXPECT_THAT(saturation.warnings(), IsEmpty());
  heartbeat.mutable_estimation()->set_bursts(1);
  heartbeat.mutable_estimation()->set_bursts_merged(3);
  saturation.check(heartbeat, kStart + 1s);
  EXPECT_THAT(saturation.reasons(), IsEmpty()) << "positions are right";
  EXPECT_THAT(
      saturation.warnings(),
      ElementsAre(::testing::AllOf(HasSubstr("more bursts come than this machine can explain"),
                                   HasSubstr("(25 % of the bursts were explained)"),
                                   HasSubstr("unlisted = \"ignore\""),
                                   HasSubstr("faster machine"))));
  saturation.check(heartbeat, kStart + 12s);
  EXPECT_THAT(saturation.warnings(), IsEmpty()) << "it is over";
}

TEST(Saturation, TheShareIsOfTheLastTenSeconds) {
  Saturation saturation;
  v1::Heartbeat heartbeat;
  for (std::uint64_t second = 0; second <= 40; ++second) {
    // Every fourth burst gives way, later every second.
    heartbeat.mutable_estimation()->set_bursts(3 * second);
    heartbeat.mutable_estimation()->set_bursts_merged(second <= 20 ? second : 3 * second - 40);
    saturation.check(heartbeat, kStart + second * 1s);
    if (second == 20) {
      EXPECT_THAT(saturation.warnings(), ElementsAre(HasSubstr("(75 % of")));
    }
  }
  EXPECT_THAT(saturation.warnings(), ElementsAre(HasSubstr("(50 % of")));
}

void set_rank(v1::RankCounters& rank, std::uint64_t explained, std::uint64_t merged) {
  rank.set_bursts(explained + merged);
  rank.set_bursts_explained(explained);
  rank.set_bursts_merged(merged);
}

TEST(Saturation, StatesTheRatesOfEachRankUntilItHasRecovered) {
  Saturation saturation;
  v1::Heartbeat heartbeat;
  v1::EstimationCounters& counters = *heartbeat.mutable_estimation();
  for (const char* const rank :
       {"listed", "listed_acquisition", "unlisted", "unlisted_acquisition"}) {
    counters.add_ranks()->set_rank(rank);
  }
  // 10 and 100 bursts a second, of which 10 and 25 are explained in the first 20 seconds, then all.
  int recovered = 0;
  for (std::uint64_t second = 0; second <= 40; ++second) {
    const std::uint64_t merged = 75 * std::min<std::uint64_t>(second, 20);
    set_rank(*counters.mutable_ranks(0), 10 * second, 0);
    set_rank(*counters.mutable_ranks(3), 100 * second - merged, merged);
    counters.set_bursts(110 * second - merged);
    counters.set_bursts_merged(merged);
    saturation.check(heartbeat, kStart + second * 1s);
    recovered += saturation.has_recovered() ? 1 : 0;
    EXPECT_EQ(saturation.warnings().size(), second > 0 && second < 30 ? 1U : 0U) << second;
    if (second == 20) {
      EXPECT_THAT(saturation.warnings(),
                  ElementsAre(::testing::AllOf(HasSubstr("listed 10.0 of 10.0"),
                                               HasSubstr("unlisted acquisition 25.0 of 100.0"),
                                               ::testing::Not(HasSubstr("listed acquisition 0")))));
    }
    EXPECT_EQ(recovered, second < 30 ? 0 : 1) << second;
  }
}

TEST(Field, BurstsThatWereLeftOutAreAWarningOfTheirOwn) {
  Saturation saturation;
  v1::Heartbeat heartbeat;
  saturation.check(heartbeat, kStart);
  heartbeat.mutable_estimation()->set_bursts_dropped(1);
  saturation.check(heartbeat, kStart + 1s);
  EXPECT_THAT(saturation.warnings(), ElementsAre(HasSubstr("too old, and were left out")));
  saturation.check(heartbeat, kStart + 12s);
  EXPECT_THAT(saturation.warnings(), IsEmpty());
}

TEST(Field, MergedBurstsAreLoggedAtOnceAndThenOccasionally) {
  std::vector<LogEvent> logged;
  const auto log =
      std::make_shared<LimitedLog>([&](const LogEvent& event) { logged.push_back(event); });
  LossWatch losses(log);
  v1::Heartbeat heartbeat;
  losses.check(heartbeat);
  EXPECT_TRUE(logged.empty());
  for (std::uint64_t merged = 1; merged < 100; ++merged) {
    heartbeat.mutable_estimation()->set_bursts_merged(merged);
    losses.check(heartbeat);
  }
  ASSERT_EQ(logged.size(), 1U);
  EXPECT_EQ(logged.front().level, LogLevel::kWarning);
  EXPECT_THAT(logged.front().message, HasSubstr("more bursts come than this machine can explain"));
}

}  // namespace
}  // namespace rayloc::saturation_test
