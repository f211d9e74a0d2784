#include "daemon/live/machine/start_resources.h"

#include <sys/resource.h>

#include <cerrno>
#include <new>
#include <stdexcept>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::field_start_resources_test {
namespace {

using ::testing::HasSubstr;

// Lowers a limit for as long as it lives.
class Lowered {
 public:
  Lowered(__rlimit_resource resource, rlim_t limit) : resource_(resource) {
    getrlimit(resource_, &before_);
    const rlimit lower{limit, before_.rlim_max};
    setrlimit(resource_, &lower);
  }
  ~Lowered() { setrlimit(resource_, &before_); }
  Lowered(const Lowered&) = delete;
  Lowered& operator=(const Lowered&) = delete;

 private:
  const __rlimit_resource resource_;
  rlimit before_{};
};

TEST(Field, StartResourcesNameTheLimitOfDescriptors) {
  EXPECT_TRUE(check_start_resources(2, 50));
  {
    const Lowered limit(RLIMIT_NOFILE, 40);
    const Expected<void> enough = check_start_resources(2, 50);
    ASSERT_FALSE(enough);
    EXPECT_EQ(enough.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(enough.error().message, HasSubstr("50 descriptors"));
    EXPECT_THAT(enough.error().message, HasSubstr("ulimit -n"));
    EXPECT_EQ(affordable_connections(64), 10U);
  }
  EXPECT_TRUE(check_start_resources(2, 50)) << "what was tried is given back";
}

TEST(Field, StartResourcesFatalMessageNamesTheMissingResource) {
  const FatalMessage memory = fatal_message(std::bad_alloc());
  EXPECT_THAT(memory.text, HasSubstr("MemoryMax="));
  EXPECT_EQ(memory.exit_status, 69);
  const auto message = [](int number) {
    return fatal_message(std::system_error(number, std::generic_category(), "what it was for"));
  };
  EXPECT_THAT(message(EAGAIN).text, HasSubstr("ulimit -u"));
  EXPECT_EQ(message(EAGAIN).exit_status, 69);
  EXPECT_THAT(message(EMFILE).text, HasSubstr("LimitNOFILE="));
  EXPECT_EQ(message(EMFILE).exit_status, 69);
  EXPECT_EQ(message(EIO).exit_status, 70);
  EXPECT_THAT(message(EIO).text, HasSubstr("internal error: what it was for"));
  EXPECT_EQ(fatal_message(std::runtime_error("our fault")).exit_status, 70);
}

}  // namespace
}  // namespace rayloc::field_start_resources_test
