#include "daemon/live/cluster/fill_queue.h"

#include <gtest/gtest.h>

#include "tests/daemon/live/cluster/some_batch.h"

namespace rayloc::fill_queue_test {
namespace {

using std::chrono::milliseconds;

constexpr FillQueue::Time kNow{std::chrono::seconds(1000)};

TEST(FillQueue, GivesOneAtATimeUntilItIsAcknowledged) {
  FillQueue queue({});
  queue.add(some_batch(4));  // nothing was received
  queue.add(some_batch(5, {{"ap1", 3}}));
  queue.add(some_batch(6, {{"ap1", 2}, {"ap2", 1}}));
  EXPECT_EQ(queue.waiting().at("ap1"), 5U);
  EXPECT_EQ(queue.next(kNow)->number, 5U);
  EXPECT_FALSE(queue.next(kNow + milliseconds(500)));
  EXPECT_EQ(queue.next(kNow + milliseconds(1000))->number, 5U);
  queue.acknowledged(6);  // it is not its turn
  queue.acknowledged(5);
  queue.acknowledged(5);
  EXPECT_EQ(queue.filled().at("ap1"), 3U);
  const auto last = queue.next(kNow + milliseconds(1001));
  ASSERT_TRUE(last);
  EXPECT_EQ(last->number, 6U);
  EXPECT_EQ(decode_batch(*last->bytes)->parts.size(), 2U);
  queue.acknowledged(6);
  EXPECT_FALSE(queue.next(kNow + milliseconds(9000)));
  EXPECT_EQ(queue.waiting().at("ap1"), 0U);
  EXPECT_EQ(queue.filled().at("ap2"), 1U);
}

TEST(FillQueue, KeepsTheNewestWhereThereIsNoRoom) {
  FillQueue::Limits limits;
  limits.bytes = 3000;
  FillQueue queue(limits);
  for (std::uint64_t number = 1; number <= 9; ++number) {
    queue.add(some_batch(number, {{"ap1", 20}}));
  }
  const auto first = queue.next(kNow);
  ASSERT_TRUE(first);
  EXPECT_GT(first->number, 1U);
  EXPECT_EQ(queue.waiting().at("ap1"), 20 * (10 - first->number));
  EXPECT_TRUE(queue.filled().empty());
}

}  // namespace
}  // namespace rayloc::fill_queue_test
