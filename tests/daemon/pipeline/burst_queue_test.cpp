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

void push(BurstQueue& queue, std::vector<Burst> ended) {
  queue.push(ended);
  EXPECT_TRUE(ended.empty());
}

TEST(BurstQueue, LiveANewerBurstTakesThePlaceOfTheOneThatWaits) {
  BurstQueue queue(Overflow::kDropOldest);
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
  BurstQueue queue(Overflow::kDropOldest);
  push(queue, {burst(1, 0)});
  EXPECT_EQ(queue.pop().first, at(0));
  push(queue, {burst(1, 200)});
  EXPECT_EQ(queue.pop().heard_since, at(200));
  EXPECT_EQ(queue.merged_bursts(), 0U);
}

TEST(BurstQueue, AReplayKeepsEveryBurstInOrder) {
  BurstQueue queue(Overflow::kWait);
  push(queue, {burst(1, 0), burst(2, 50), burst(1, 200)});
  push(queue, {burst(1, 400)});
  std::vector<Timestamp> order;
  while (!queue.empty()) {
    order.push_back(queue.pop().first);
  }
  EXPECT_EQ(order, (std::vector{at(0), at(50), at(200), at(400)}));
  EXPECT_EQ(queue.merged_bursts(), 0U);
}

}  // namespace
}  // namespace rayloc
