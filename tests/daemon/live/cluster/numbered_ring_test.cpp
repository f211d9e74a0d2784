#include "daemon/live/cluster/numbered_ring.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/cluster/some_batch.h"

namespace rayloc::numbered_ring_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::Pair;

const NumberedRing::Time kBegin{seconds(1000)};

// added = live + marked + waiting, of each access point.
void expect_law(const NumberedRing& ring) {
  NumberedRing::Counters counters = ring.counters();
  for (const auto& [access_point, added] : counters.added) {
    EXPECT_EQ(added,
              counters.live[access_point] + counters.marked[access_point] +
                  counters.waiting[access_point])
        << access_point;
  }
}

std::vector<std::uint64_t> send_all(NumberedRing& ring, NumberedRing::Time now) {
  std::vector<std::uint64_t> numbers;
  while (const auto one = ring.next(now)) {
    numbers.push_back(one->number);
  }
  return numbers;
}

Batch last_sent(NumberedRing& ring, NumberedRing::Time now) {
  Batch batch;
  while (const auto one = ring.next(now)) {
    batch = *decode_batch(*one->bytes);
  }
  return batch;
}

void add(NumberedRing& ring, std::size_t datagrams, NumberedRing::Time now) {
  ring.add(some_batch(1, {{"ap1", datagrams}}), now);
}

TEST(NumberedRing, NumbersFromOneAndKeepsUntilConsumed) {
  NumberedRing ring(kSomeEpoch, {});
  add(ring, 3, kBegin);
  add(ring, 4, kBegin);
  EXPECT_THAT(send_all(ring, kBegin), ElementsAre(1, 2));
  ring.acknowledged(1);
  ring.acknowledged(2);
  EXPECT_FALSE(ring.owes());
  EXPECT_EQ(ring.counters().kept, 2U);
  EXPECT_EQ(ring.counters().live.at("ap1"), 7U);
  ring.consumed(1);
  EXPECT_EQ(ring.counters().kept, 1U);
  ring.consumed(9);
  EXPECT_EQ(ring.counters().kept, 0U);
  EXPECT_EQ(ring.counters().kept_bytes, 0U);
  expect_law(ring);
}

TEST(NumberedRing, ResendsUnacknowledgedBatches) {
  NumberedRing ring(kSomeEpoch, {});
  add(ring, 1, kBegin);
  ASSERT_TRUE(ring.next(kBegin));
  EXPECT_FALSE(ring.next(kBegin + milliseconds(999)));
  const auto again = ring.next(kBegin + seconds(1));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->repeat, 0U);  // the same id: the broker stores it once
  EXPECT_EQ(ring.counters().repeated, 1U);
  ring.acknowledged(1);
  EXPECT_FALSE(ring.owes());
  ring.acknowledged(1);  // both of them
  expect_law(ring);
}

TEST(NumberedRing, BatchesTheBrokerMissedBecomeOneGapMark) {
  NumberedRing ring(kSomeEpoch, {});
  for (int i = 0; i < 5; ++i) {
    add(ring, 2, kBegin + i * milliseconds(20));
  }
  ring.tend(kBegin + seconds(2) + milliseconds(60));
  EXPECT_EQ(ring.counters().marked.at("ap1"), 8U);
  expect_law(ring);
  const auto next = ring.next(kBegin + seconds(3));
  ASSERT_TRUE(next);
  const Expected<Batch> live = decode_batch(*next->bytes);
  ASSERT_TRUE(live);
  EXPECT_EQ(live->number, 5U);
  ASSERT_EQ(live->gaps.size(), 1U);
  EXPECT_EQ(live->gaps[0].from, 1U);
  EXPECT_EQ(live->gaps[0].to, 4U);
  EXPECT_THAT(live->gaps[0].datagrams, ElementsAre(Pair("ap1", 8)));
  EXPECT_EQ(live->gaps[0].reason, "the broker was absent");
}

TEST(NumberedRing, TheWindowBoundsUnacknowledgedBytes) {
  NumberedRing::Limits limits;
  limits.window_bytes = 1;
  NumberedRing ring(kSomeEpoch, limits);
  add(ring, 1, kBegin);
  add(ring, 1, kBegin);
  EXPECT_THAT(send_all(ring, kBegin), ElementsAre(1));
  EXPECT_FALSE(ring.has_next());
  ring.acknowledged(1);
  EXPECT_TRUE(ring.has_next());
  EXPECT_THAT(send_all(ring, kBegin), ElementsAre(2));
}

TEST(NumberedRing, ResendsRequestedBatchesUnderAnotherId) {
  NumberedRing ring(kSomeEpoch, {});
  for (int i = 0; i < 3; ++i) {
    add(ring, 1, kBegin);
  }
  send_all(ring, kBegin);
  for (const std::uint64_t number : {1U, 2U, 3U}) {
    ring.acknowledged(number);
  }
  ring.ask(2, 7);
  const auto first = ring.next(kBegin);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->number, 2U);
  EXPECT_EQ(first->repeat, 1U);
  expect_law(ring);
  EXPECT_EQ(ring.next(kBegin)->number, 3U);
  EXPECT_FALSE(ring.next(kBegin));  // four to seven are not there yet
  ring.acknowledged(2);
  ring.acknowledged(3);
  expect_law(ring);
  EXPECT_EQ(ring.counters().asked_for, 2U);
}

TEST(NumberedRing, MarksRequestedBatchesThatAreNoLongerKept) {
  NumberedRing ring(kSomeEpoch, {});
  add(ring, 3, kBegin);
  send_all(ring, kBegin);
  ring.acknowledged(1);
  ring.tend(kBegin + seconds(31));
  EXPECT_EQ(ring.counters().kept, 0U);
  EXPECT_EQ(ring.counters().live.at("ap1"), 3U);
  ring.ask(1, 1);
  EXPECT_EQ(ring.counters().marked.at("ap1"), 3U);
  expect_law(ring);
  add(ring, 1, kBegin + seconds(31));
  const Batch batch = last_sent(ring, kBegin + seconds(31));
  ASSERT_EQ(batch.gaps.size(), 1U);
  EXPECT_EQ(batch.gaps[0].datagrams.at("ap1"), 3U);
  EXPECT_EQ(batch.gaps[0].reason, "no longer kept");
  EXPECT_EQ(batch.oldest_kept, 2U);
}

TEST(NumberedRing, RepeatsALostGapMark) {
  NumberedRing ring(kSomeEpoch, {});
  add(ring, 5, kBegin);
  ring.tend(kBegin + seconds(2));  // marked
  add(ring, 1, kBegin + seconds(2));
  EXPECT_EQ(last_sent(ring, kBegin + seconds(2)).gaps.size(), 1U);
  ring.acknowledged(2);
  ring.ask(1, 1);  // its mark is in a batch that is still kept
  EXPECT_FALSE(ring.owes());
  ring.tend(kBegin + seconds(40));  // no longer
  ring.ask(1, 2);
  add(ring, 1, kBegin + seconds(40));
  const Batch batch = last_sent(ring, kBegin + seconds(40));
  ASSERT_EQ(batch.gaps.size(), 2U);
  EXPECT_EQ(batch.gaps[0].datagrams.at("ap1"), 5U);
  EXPECT_EQ(batch.gaps[1].datagrams.at("ap1"), 1U);
  expect_law(ring);
}

TEST(NumberedRing, BoundsTheKeptBytes) {
  NumberedRing::Limits limits;
  limits.keep_bytes = 2000;
  NumberedRing ring(kSomeEpoch, limits);
  for (int i = 0; i < 100; ++i) {
    add(ring, 10, kBegin);
    for (const std::uint64_t number : send_all(ring, kBegin)) {
      ring.acknowledged(number);
    }
    ring.tend(kBegin);
    EXPECT_LE(ring.counters().kept_bytes, limits.keep_bytes);
  }
  EXPECT_EQ(ring.counters().live.at("ap1"), 1000U);
}

// For any behaviour of the broker, in any order.
TEST(NumberedRing, TheLawHoldsAfterEveryStep) {
  std::mt19937 random(7);
  NumberedRing::Limits limits;
  limits.keep = seconds(3);
  limits.window_bytes = 300;
  NumberedRing ring(kSomeEpoch, limits);
  NumberedRing::Time now = kBegin;
  std::vector<std::uint64_t> sent;
  const auto any = [&](std::uint64_t most) { return random() % (most + 1); };
  for (int i = 0; i < 5'000; ++i) {
    now += milliseconds(any(60));
    const std::uint64_t last = ring.counters().batches;
    switch (any(7)) {
      case 0:
      case 1:
        ring.add(some_batch(1, {{"ap1", any(4)}, {"ap2", any(1)}}), now);
        break;
      case 2:
        for (const std::uint64_t number : send_all(ring, now)) {
          sent.push_back(number);
        }
        break;
      case 3:
        ring.not_sent(any(last));
        break;
      case 4:
      case 5:
        if (!sent.empty()) {
          ring.acknowledged(sent[sent.size() - 1 - std::min(sent.size() - 1, any(9))]);
        }
        break;
      case 6:
        ring.ask(last - std::min(last, any(20)), last);
        break;
      default:
        ring.consumed(last - std::min<std::uint64_t>(last, 30));
        ring.tend(now);
        break;
    }
    expect_law(ring);
  }
  EXPECT_GT(ring.counters().marked_batches, 100U);
  EXPECT_GT(ring.counters().asked_for, 20U);
}

}  // namespace
}  // namespace rayloc::numbered_ring_test
