#include "engine/scene/embree_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::field_embree_error_test {
namespace {

using ::testing::HasSubstr;

TEST(Field, ATreeWithoutMemoryNamesTheLimit) {
  const Error memory = embree_error(RTC_ERROR_OUT_OF_MEMORY).value();
  EXPECT_EQ(memory.kind, ErrorKind::kUnavailable);
  EXPECT_THAT(memory.message, HasSubstr("ulimit -v, MemoryMax="));
  const Error other = embree_error(RTC_ERROR_UNSUPPORTED_CPU).value();
  EXPECT_EQ(other.kind, ErrorKind::kInternal);
  EXPECT_THAT(other.message, HasSubstr("(error 5)"));
}

}  // namespace
}  // namespace rayloc::field_embree_error_test
