#include "daemon/live/health/readiness.h"

#include <gtest/gtest.h>

namespace rayloc::readiness_test {
namespace {

TEST(Readiness, TheKernelClockStateOverridesTheMarkOfTimesyncd) {
  for (const bool marked : {false, true}) {
    EXPECT_EQ(clock_state(true, marked), ClockState::kSynchronized);
    EXPECT_EQ(clock_state(false, marked), ClockState::kNotSynchronized) << "the mark is older";
  }
  EXPECT_EQ(clock_state(std::nullopt, true), ClockState::kSynchronized);
  EXPECT_EQ(clock_state(std::nullopt, false), ClockState::kUnknown);
}

TEST(Field, ASourceWhoseDatagramsAreRejectedIsNotReady) {
  StatusMessages status;
  v1::SourceState source;
  source.set_access_point("ap1");
  source.set_status(v1::SOURCE_STATUS_RECEIVING);
  status.sources.push_back(source);
  EXPECT_TRUE(readiness(status, {}).ready());
  status.sources[0].set_detail("another channel");
  ASSERT_EQ(readiness(status, {}).reasons.size(), 1U);
  EXPECT_EQ(readiness(status, {}).reasons[0], "source ap1: another channel");
}

TEST(Readiness, AnUnknownClockCausesNoWarning) {
  ServiceHealth health;
  health.clock = ClockState::kUnknown;
  EXPECT_EQ(to_json(readiness({}, health)),
            "{\"ready\":true,\"reasons\":[],\"warnings\":[],\"clock\":\"unknown\"}\n");
  health.clock = ClockState::kSynchronized;
  EXPECT_EQ(to_json(readiness({}, health)),
            "{\"ready\":true,\"reasons\":[],\"warnings\":[],\"clock\":\"synchronised\"}\n");
  health.clock = ClockState::kNotSynchronized;
  const Readiness off = readiness({}, health);
  EXPECT_TRUE(off.ready());
  EXPECT_EQ(off.warnings.size(), 1U);
}

TEST(Field, ObstaclesToLocatingPreventReadiness) {
  ServiceHealth health;
  health.lacks.obstacles = {"nothing can be located: the site is not calibrated"};
  health.lacks.warnings = {"people are not looked for"};
  health.overloaded = {"more bursts come than this machine can explain"};
  const Readiness result = readiness({}, health);
  EXPECT_FALSE(result.ready());
  EXPECT_EQ(result.reasons, health.lacks.obstacles);
  EXPECT_EQ(result.warnings,
            (std::vector<std::string>{health.lacks.warnings[0], health.overloaded[0]}));
}

TEST(Field, PublicWarningsListObstaclesAndRecordingErrors) {
  ServiceHealth health;
  health.lacks.obstacles = {"not calibrated"};
  health.lacks.warnings = {"no people"};
  health.saturated = {"frames were dropped"};
  health.overloaded = {"too many bursts"};
  health.recording_errors = {"the disk is full"};
  health.reload_failed = true;  // irrelevant to viewers of the map
  EXPECT_EQ(public_warnings(health),
            (std::vector<std::string>{"not calibrated",
                                      "no people",
                                      "frames were dropped",
                                      "too many bursts",
                                      "recording: the disk is full"}));
}

}  // namespace
}  // namespace rayloc::readiness_test
