#include "daemon/live/cluster/nats/batch_replies.h"

#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/patience.h"

namespace rayloc::nats::batch_replies_test {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;

const auto kLong = test::patient(std::chrono::seconds(20));
bool yes() { return true; }
bool no() { return false; }

BatchReplies::Reply message(std::uint64_t sequence, bool states_pending = true) {
  return {"", states_pending, {"in.x", sequence, std::to_string(sequence)}};
}

std::vector<std::string> data(const Expected<std::vector<BrokerMessage>>& messages) {
  std::vector<std::string> all;
  for (const BrokerMessage& one : messages.value()) {
    all.push_back(one.data);
  }
  return all;
}

TEST(BatchReplies, EndWithTheStatusOfTheServer) {
  BatchReplies replies;
  std::thread server([&] {
    replies.take(message(4));
    replies.take(message(5));
    replies.take({"204"});
  });
  EXPECT_THAT(data(replies.wait(kLong, yes)), ElementsAre("4", "5"));
  server.join();
}

TEST(BatchReplies, OfAnOldServerAreOneMessage) {
  BatchReplies replies;
  replies.take(message(4, false));
  EXPECT_THAT(data(replies.wait(kLong, yes)), ElementsAre("4"));
}

TEST(BatchReplies, AreEmptyWhereThereIsNoMessage) {
  BatchReplies replies;
  replies.take({"404"});
  EXPECT_THAT(data(replies.wait(kLong, yes)), ElementsAre());
}

TEST(BatchReplies, ThatEndEarlyAreUsed) {
  BatchReplies replies;
  replies.take(message(4));
  EXPECT_THAT(data(replies.wait(milliseconds(1), yes)), ElementsAre("4"));
  BatchReplies lost;
  lost.take(message(6));
  EXPECT_THAT(data(lost.wait(kLong, no)), ElementsAre("6"));
}

TEST(BatchReplies, ThatAreAbsentOrRefusalsAreErrors) {
  BatchReplies none;
  EXPECT_FALSE(none.wait(milliseconds(1), yes));
  EXPECT_FALSE(none.wait(kLong, no));
  BatchReplies refused;
  refused.take({"503"});
  const auto answer = refused.wait(kLong, yes);
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, ::testing::HasSubstr("503"));
}

}  // namespace
}  // namespace rayloc::nats::batch_replies_test
