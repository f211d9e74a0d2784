// Each test runs in a process of its own: the handlers and the flag belong to the process.
#include "daemon/cli/terminal/stop_signal.h"

#include <unistd.h>

#include <csignal>

#include <gtest/gtest.h>

namespace rayloc::cli::stop_signal_test {
namespace {

using ::testing::ExitedWithCode;
using ::testing::KilledBySignal;

[[noreturn]] void exit_with(bool success) { ::_exit(success ? 0 : 1); }

TEST(StopSignalDeathTest, IsNotedAndDoesNotEndTheProcess) {
  EXPECT_EXIT(
      {
        StopSignal::install();
        const bool before = StopSignal::requested();
        std::raise(SIGINT);
        std::raise(SIGTERM);
        exit_with(!before && StopSignal::requested());
      },
      ExitedWithCode(0),
      "");
}

TEST(StopSignalDeathTest, EndsTheProcessTheSecondTime) {
  EXPECT_EXIT(
      {
        StopSignal::install_once();
        std::raise(SIGINT);
        if (StopSignal::requested()) {
          std::raise(SIGTERM);
        }
        exit_with(false);
      },
      KilledBySignal(SIGTERM),
      "");
}

TEST(StopSignalDeathTest, EndsTheProcessAsAnInterruptWouldWhenAsked) {
  EXPECT_EXIT(
      {
        StopSignal::install();
        StopSignal::end_if_requested();  // returns: no signal came
        std::raise(SIGTERM);
        StopSignal::end_if_requested();
        exit_with(false);
      },
      KilledBySignal(SIGINT),
      "");
}

}  // namespace
}  // namespace rayloc::cli::stop_signal_test
