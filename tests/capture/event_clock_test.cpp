// Tests EventClock on a machine whose clock is set while datagrams arrive.
#include "capture/source/event_clock.h"

#include <gtest/gtest.h>

namespace rayloc::event_clock_test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// CLOCK_REALTIME and CLOCK_MONOTONIC of a machine.
struct Machine {
  Timestamp realtime{seconds(1'700'000'000)};
  Duration monotonic{seconds(100)};

  void pass(Duration time) {
    realtime += time;
    monotonic += time;
  }
  void set_clock(Duration by) { realtime += by; }
};

TEST(EventClock, TruncatesToMicroseconds) {
  EventClock clock;
  EXPECT_EQ(clock.event_time(Timestamp(Duration(1'999))), Timestamp(Duration(1'000)));
  EXPECT_EQ(clock.event_time(Timestamp(Duration(-1))), Timestamp(Duration(-1'000)));
}

TEST(EventClock, WatermarkOfAnEmptySocketIsJustBeforeTheClock) {
  EventClock clock;
  const Machine machine;
  clock.observe(machine.realtime, machine.monotonic);
  EXPECT_EQ(clock.watermark(), Timestamp::min());
  clock.drained();
  EXPECT_EQ(clock.watermark(), machine.realtime - EventClock::kQueueing);
}

TEST(EventClock, GoesOnWhenTheClockIsSetBack) {
  EventClock clock;
  Machine machine;
  clock.observe(machine.realtime, machine.monotonic);
  clock.drained();
  const Timestamp before = clock.event_time(machine.realtime);
  machine.set_clock(-seconds(3600));
  machine.pass(milliseconds(50));
  clock.observe(machine.realtime, machine.monotonic);
  EXPECT_EQ(clock.steps(), 1U);
  EXPECT_EQ(clock.ahead(), -seconds(3600));
  EXPECT_EQ(clock.event_time(machine.realtime), before + milliseconds(50));
  clock.drained();
  EXPECT_EQ(clock.watermark(), before + milliseconds(50) - EventClock::kQueueing);

  // Set right again: event time falls in with the clock.
  machine.set_clock(seconds(3600));
  machine.pass(milliseconds(50));
  clock.observe(machine.realtime, machine.monotonic);
  EXPECT_EQ(clock.event_time(machine.realtime), machine.realtime);
  EXPECT_EQ(clock.steps(), 2U);
}

TEST(EventClock, GoesOnEvenlyWhenTheClockIsSetForward) {
  EventClock clock;
  Machine machine;
  clock.observe(machine.realtime, machine.monotonic);
  const Timestamp before = clock.event_time(machine.realtime);
  EXPECT_EQ(clock.ahead(), Duration::zero());
  machine.set_clock(seconds(3600));
  machine.pass(milliseconds(50));
  clock.observe(machine.realtime, machine.monotonic);
  EXPECT_EQ(clock.event_time(machine.realtime), before + milliseconds(50));
  EXPECT_EQ(clock.ahead(), seconds(3600));
  EXPECT_EQ(clock.steps(), 1U);
}

TEST(EventClock, GivesNoTimeBeforeTheWatermark) {
  EventClock clock;
  const Machine machine;
  clock.observe(machine.realtime, machine.monotonic);
  clock.drained();
  EXPECT_EQ(clock.event_time(machine.realtime - seconds(1)), clock.watermark());
}

TEST(EventClock, TakesReadingJitterForNoStep) {
  EventClock clock;
  Machine machine;
  clock.observe(machine.realtime, machine.monotonic);
  machine.set_clock(microseconds(-900));
  clock.observe(machine.realtime, machine.monotonic);
  EXPECT_EQ(clock.steps(), 0U);
}

}  // namespace
}  // namespace rayloc::event_clock_test
