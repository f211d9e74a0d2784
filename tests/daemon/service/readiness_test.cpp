#include "daemon/service/readiness.h"

#include <gtest/gtest.h>

namespace rayloc {
namespace {

TEST(Readiness, TheClockIsWhatTheKernelSaysElseWhatTimesyncdMarked) {
  for (const bool marked : {false, true}) {
    EXPECT_EQ(clock_state(true, marked), ClockState::kSynchronized);
    EXPECT_EQ(clock_state(false, marked), ClockState::kNotSynchronized) << "the mark is older";
  }
  EXPECT_EQ(clock_state(std::nullopt, true), ClockState::kSynchronized);
  EXPECT_EQ(clock_state(std::nullopt, false), ClockState::kUnknown);
}

TEST(Readiness, AClockOfWhichNothingIsKnownIsNoWarning) {
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

}  // namespace
}  // namespace rayloc
