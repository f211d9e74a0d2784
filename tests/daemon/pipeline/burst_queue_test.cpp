#include "daemon/pipeline/burst_queue.h"

#include <gtest/gtest.h>

namespace rayloc {
namespace {

using std::chrono::milliseconds;

Timestamp at(int ms) { return Timestamp(milliseconds(ms)); }

// Of three kept frames, and a surplus one.
Burst burst(std::uint8_t transmitter, int ms) {
  Burst burst;
  burst.transmitter.octets[5] = transmitter;
  burst.first = at(ms);
  burst.heard_since = burst.first;
  burst.last = at(ms + 150);
  burst.frames.resize(3);
  burst.surplus = 1;
  return burst;
}

void push(BurstQueue& queue, std::vector<Burst> ended, Timestamp now = at(0)) {
  queue.push(ended, now);
  EXPECT_TRUE(ended.empty());
}

// The transmitters in the order in which they are explained.
std::vector<int> pop_all(BurstQueue& queue) {
  std::vector<int> order;
  while (!queue.empty()) {
    order.push_back(queue.pop().transmitter.octets[5]);
  }
  return order;
}

// The first nine are listed, those up to 19 have tracks.
BurstQueueOptions ranked() {
  BurstQueueOptions options;
  options.rank = [](const MacAddress& transmitter) {
    const int number = transmitter.octets[5];
    return number < 10 ? Rank::kListed : number < 20 ? Rank::kTracked : Rank::kOther;
  };
  return options;
}

TEST(BurstQueue, LiveANewerBurstTakesThePlaceOfTheOneThatWaits) {
  BurstQueue queue(ranked());
  push(queue, {burst(1, 0), burst(2, 50)});
  push(queue, {burst(1, 200), burst(1, 400)});
  EXPECT_EQ(queue.size(), 2U);
  EXPECT_EQ(queue.frames(), 8U);
  EXPECT_EQ(queue.merged_bursts(), 2U);
  EXPECT_EQ(queue.merged_frames(), 8U);
  EXPECT_EQ(queue.earliest(at(1000)), at(50));

  // The first transmitter has waited longest: it keeps its turn.
  const Burst first = queue.pop();
  EXPECT_EQ(first.transmitter.octets[5], 1);
  EXPECT_EQ(first.first, at(400));
  EXPECT_EQ(first.heard_since, at(0));
  const Burst second = queue.pop();
  EXPECT_EQ(second.transmitter.octets[5], 2);
  EXPECT_EQ(second.heard_since, second.first);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.frames(), 0U);
  EXPECT_EQ(queue.earliest(at(1000)), at(1000));
}

TEST(BurstQueue, WhatHasBeenTakenIsNotMerged) {
  BurstQueue queue({});
  push(queue, {burst(1, 0)});
  EXPECT_EQ(queue.pop().first, at(0));
  push(queue, {burst(1, 200)});
  EXPECT_EQ(queue.pop().heard_since, at(200));
  EXPECT_EQ(queue.merged_bursts(), 0U);
}

TEST(BurstQueue, AReplayKeepsEveryBurstInOrder) {
  BurstQueueOptions options = ranked();
  options.overflow = Overflow::kWait;
  options.max_frames = 1;
  BurstQueue queue(options);
  push(queue, {burst(30, 0), burst(2, 50), burst(30, 200)});
  push(queue, {burst(1, 400)}, at(1'000'000));
  std::vector<Timestamp> order;
  while (!queue.empty()) {
    order.push_back(queue.pop().first);
  }
  EXPECT_EQ(order, (std::vector{at(0), at(50), at(200), at(400)}));
  EXPECT_EQ(queue.merged_bursts(), 0U);
  EXPECT_EQ(queue.dropped_bursts(), 0U);
}

TEST(Field, BurstQueueTakesListedTransmittersFirstThenTracksThenTheNewest) {
  BurstQueue queue(ranked());
  push(queue, {burst(20, 0), burst(21, 10), burst(11, 20), burst(22, 30), burst(10, 40)});
  push(queue, {burst(2, 50), burst(1, 60), burst(23, 70)});
  // A newer burst makes a stranger the newest, and leaves the others their turn.
  push(queue, {burst(20, 300), burst(11, 310), burst(2, 320)});
  EXPECT_EQ(pop_all(queue), (std::vector{2, 1, 11, 10, 20, 23, 22, 21}));
}

TEST(Field, BurstQueueDropsAndCountsWhatHasWaitedTooLong) {
  BurstQueue queue(ranked());
  push(queue, {burst(20, 0), burst(1, 0), burst(2, 500)}, at(3150));
  EXPECT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue.dropped_bursts(), 0U);
  push(queue, {}, at(3151));
  EXPECT_EQ(queue.dropped_bursts(), 2U);
  EXPECT_EQ(queue.dropped_frames(), 8U);
  EXPECT_EQ(queue.frames(), 4U);
  // One who goes on is not old, however long it has waited for its turn.
  push(queue, {burst(2, 3000)}, at(6000));
  EXPECT_EQ(pop_all(queue), (std::vector{2}));
  EXPECT_EQ(queue.dropped_bursts(), 2U);
  EXPECT_EQ(queue.merged_bursts(), 1U);
  // Who was dropped begins anew.
  push(queue, {burst(1, 6000)}, at(6200));
  EXPECT_EQ(queue.pop().heard_since, at(6000));
}

TEST(Field, BurstQueueHoldsABoundedNumberOfFrames) {
  BurstQueueOptions options = ranked();
  options.max_frames = 12;  // of three bursts
  BurstQueue queue(options);
  push(queue, {burst(20, 0), burst(1, 10), burst(21, 20), burst(10, 30), burst(22, 40)});
  EXPECT_EQ(queue.frames(), 12U);
  EXPECT_EQ(queue.dropped_bursts(), 2U);
  EXPECT_EQ(queue.dropped_frames(), 8U);
  EXPECT_EQ(pop_all(queue), (std::vector{1, 10, 22}));
}

}  // namespace
}  // namespace rayloc
