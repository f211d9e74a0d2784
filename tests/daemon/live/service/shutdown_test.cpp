#include "daemon/live/service/shutdown.h"

#include <atomic>
#include <future>
#include <memory>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/eventually.h"
#include "tests/support/patience.h"

namespace rayloc::shutdown_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Shutdown::Time in(std::chrono::milliseconds time) {
  return std::chrono::steady_clock::now() + time;
}

TEST(Shutdown, StepsFollowOneAnother) {
  std::vector<int> done;
  Shutdown shutdown;
  EXPECT_TRUE(shutdown.run("first", in(test::patient(60s)), [&] { done.push_back(1); }));
  EXPECT_TRUE(shutdown.run("second", in(test::patient(60s)), [&] { done.push_back(2); }));
  EXPECT_THAT(done, ElementsAre(1, 2));
  EXPECT_THAT(shutdown.hung(), IsEmpty());
}

// The recordings are closed although the estimator does not come back, and its name is known.
TEST(Shutdown, AHangingStepIsNamedAndBlocksNoOther) {
  const auto release = std::make_shared<std::promise<void>>();
  const auto over = std::make_shared<std::promise<void>>();
  bool closed = false;
  {
    Shutdown shutdown;
    EXPECT_FALSE(shutdown.run("estimation", in(10ms), [release, over] {
      release->get_future().wait();
      over->set_value();
    }));
    EXPECT_FALSE(shutdown.wait_for("estimation", in(10ms)));
    EXPECT_TRUE(shutdown.run("recorder ap1", in(test::patient(60s)), [&] { closed = true; }));
    EXPECT_THAT(shutdown.hung(), ElementsAre("estimation"));
  }
  EXPECT_TRUE(closed);
  release->set_value();
  over->get_future().wait();
}

TEST(Shutdown, AStepThatIsLateMayStillCome) {
  std::promise<void> release;
  Shutdown shutdown;
  EXPECT_FALSE(shutdown.run("estimation", in(10ms), [&] { release.get_future().wait(); }));
  release.set_value();
  EXPECT_TRUE(shutdown.wait_for("estimation", in(test::patient(60s))));
  EXPECT_THAT(shutdown.hung(), IsEmpty());
}

TEST(Shutdown, OnlyStepsThatHaveNotReturnedAreLeft) {
  std::promise<void> release;
  std::promise<void> never;
  const std::shared_future<void> ends = never.get_future().share();
  Shutdown shutdown;
  EXPECT_TRUE(shutdown.all_returned());
  EXPECT_FALSE(shutdown.run("estimation", in(10ms), [&] { release.get_future().wait(); }));
  EXPECT_FALSE(shutdown.run("recorder ap1", in(10ms), [ends] { ends.wait(); }));
  EXPECT_FALSE(shutdown.all_returned());
  release.set_value();
  EXPECT_TRUE(eventually(60s, [&] {
    EXPECT_FALSE(shutdown.all_returned());
    return shutdown.hung().size() == 1;
  }));
  EXPECT_THAT(shutdown.hung(), ElementsAre("recorder ap1"));
  never.set_value();
  EXPECT_TRUE(eventually(60s, [&] { return shutdown.all_returned(); }));
  EXPECT_THAT(shutdown.hung(), IsEmpty());
}

TEST(Shutdown, ALateStepThatFailsIsReportedAndEndsNothing) {
  std::promise<void> release;
  Shutdown shutdown;
  EXPECT_FALSE(shutdown.run("estimation", in(10ms), [&] {
    release.get_future().wait();
    throw std::runtime_error("zmq");
  }));
  EXPECT_FALSE(shutdown.all_returned());
  EXPECT_THAT(shutdown.take_failures(), IsEmpty());
  release.set_value();
  ASSERT_TRUE(eventually(60s, [&] { return shutdown.all_returned(); }));
  const std::vector<Shutdown::Failure> failures = shutdown.take_failures();
  ASSERT_EQ(failures.size(), 1U);
  EXPECT_EQ(failures[0].step, "estimation");
  EXPECT_EQ(failures[0].reason, "zmq");
  EXPECT_THAT(shutdown.take_failures(), IsEmpty());
}

TEST(Shutdown, RethrowsExceptionsOfAStep) {
  Shutdown shutdown;
  EXPECT_THROW(
      shutdown.run("publisher", in(test::patient(60s)), [] { throw std::runtime_error("zmq"); }),
      std::runtime_error);
}

}  // namespace
}  // namespace rayloc::shutdown_test
