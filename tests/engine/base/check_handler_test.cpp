// Tests a failed RAYLOC_CHECK: without a handler it stops the program, with one it may throw.
#include "engine/base/check_handler.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/check.h"
#include "engine/base/parallel.h"

namespace rayloc::check_handler_test {
namespace {

class CheckHandlerTest : public ::testing::Test {
 protected:
  void TearDown() override { set_check_handler(nullptr); }
};
using CheckHandlerDeathTest = CheckHandlerTest;

constexpr auto kThrow = [](const std::string& message) { throw std::logic_error(message); };

void fail_at(std::size_t index) { RAYLOC_CHECK(index != 7); }

TEST_F(CheckHandlerDeathTest, StopsTheProgramWithoutAHandler) {
  EXPECT_DEATH(fail_at(7), "check_handler_test.cpp:[0-9]+: check failed: index != 7");
}

TEST_F(CheckHandlerDeathTest, StopsTheProgramIfTheHandlerReturns) {
  set_check_handler([](const std::string& /*message*/) {});
  EXPECT_DEATH(fail_at(7), "check failed: index != 7");
}

TEST_F(CheckHandlerTest, PassesTheExceptionOfTheHandlerThroughThreads) {
  set_check_handler(kThrow);
  try {
    parallel_for(100, 1, fail_at);
    FAIL();
  } catch (const std::logic_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("check failed: index != 7"));
  }
}

}  // namespace
}  // namespace rayloc::check_handler_test
