#include "daemon/live/health/loss_watch.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::loss_watch_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Losses : public ::testing::Test {
 protected:
  // The messages that these counters cause.
  std::vector<std::string> logged(const v1::Heartbeat& heartbeat) {
    messages_.clear();
    watch_.check(heartbeat);
    log_->finish();  // those that are held back as well
    return messages_;
  }

 private:
  std::vector<std::string> messages_;
  const std::shared_ptr<LimitedLog> log_ = std::make_shared<LimitedLog>(
      [this](const LogEvent& event) { messages_.push_back(event.message); });
  LossWatch watch_{log_, "site 'hall': "};
};

TEST_F(Losses, OfAStreamAreLoggedByReason) {
  v1::Heartbeat heartbeat;
  EXPECT_THAT(logged(heartbeat), IsEmpty());
  v1::StreamCounters& stream = *heartbeat.mutable_stream();
  stream.set_refused(1);
  EXPECT_THAT(logged(heartbeat),
              ElementsAre(AllOf(HasSubstr("site 'hall': "), HasSubstr("refused"))));
  EXPECT_THAT(logged(heartbeat), IsEmpty());
  stream.set_lost(2);
  stream.set_missing(3);
  stream.set_unknown(4);
  EXPECT_THAT(logged(heartbeat),
              ElementsAre(HasSubstr("retention_s"), HasSubstr("marked"), HasSubstr("site.toml")));
  stream.set_refused(5);
  EXPECT_THAT(logged(heartbeat), ElementsAre(HasSubstr("refused")));
}

}  // namespace
}  // namespace rayloc::loss_watch_test
