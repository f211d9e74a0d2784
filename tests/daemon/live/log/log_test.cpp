#include "daemon/live/log/log.h"

#include <cstdlib>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

namespace rayloc::log_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Names of files, of their contents and of the network are quoted in the log.
TEST(Field, LogHasNoControlCharactersAndNoEntriesOfOthers) {
  unsetenv("JOURNAL_STREAM");
  const auto before = spdlog::default_logger();
  testing::internal::CaptureStderr();
  set_up_log({});
  log_event({LogLevel::kInfo, "shape '\x1b[31mred\r' first\nsecond", {{"source", "a\x07\nb"}}});
  spdlog::default_logger()->flush();
  const std::string text = testing::internal::GetCapturedStderr();
  spdlog::set_default_logger(before);
  EXPECT_THAT(text, HasSubstr("info shape '?[31mred?' first?second source=a??b\n"));
  for (const char control : {'\x1b', '\r', '\x07'}) {
    EXPECT_THAT(text, Not(HasSubstr(std::string(1, control))));
  }
}

}  // namespace
}  // namespace rayloc::log_test
