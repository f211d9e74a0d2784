#include "daemon/pipeline/burst_queue.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::burst_queue_test {
namespace {

using std::chrono::milliseconds;

Timestamp at(int ms) { return Timestamp(milliseconds(ms)); }

// A burst of three kept frames and a surplus one.
Burst burst(std::uint8_t transmitter, int ms) {
  Burst burst;
  burst.transmitter.octets[5] = transmitter;
  burst.first = at(ms);
  burst.received_since = burst.first;
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

// The first nine are listed, of these the last five have no track; those from 10 to 19 have tracks.
BurstQueueOptions ranked() {
  BurstQueueOptions options;
  options.rank = [](const MacAddress& transmitter) {
    const int number = transmitter.octets[5];
    return number < 5    ? Rank::kListed
           : number < 10 ? Rank::kListedAcquisition
           : number < 20 ? Rank::kTracked
                         : Rank::kOther;
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
  EXPECT_EQ(first.received_since, at(0));
  const Burst second = queue.pop();
  EXPECT_EQ(second.transmitter.octets[5], 2);
  EXPECT_EQ(second.received_since, second.first);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.frames(), 0U);
  EXPECT_EQ(queue.earliest(at(1000)), at(1000));
}

TEST(BurstQueue, DoesNotMergeIntoTakenBursts) {
  BurstQueue queue({});
  push(queue, {burst(1, 0)});
  EXPECT_EQ(queue.pop().first, at(0));
  push(queue, {burst(1, 200)});
  EXPECT_EQ(queue.pop().received_since, at(200));
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

TEST(Field, BurstQueueTakesListedTransmittersFirstThenTracksThenTheRest) {
  BurstQueue queue(ranked());
  push(queue, {burst(20, 0), burst(21, 10), burst(11, 20), burst(22, 30), burst(10, 40)});
  push(queue, {burst(2, 50), burst(1, 60), burst(23, 70)});
  // A newer burst keeps the turn of its transmitter.
  push(queue, {burst(20, 300), burst(11, 310), burst(2, 320)});
  EXPECT_EQ(pop_all(queue), (std::vector{2, 1, 11, 10, 20, 21, 22, 23}));
}

// More than there is time for: one is explained, then all have a newer burst.
std::map<int, int> explained_under_load(const std::vector<std::uint8_t>& transmitters, int times) {
  BurstQueue queue(ranked());
  std::map<int, int> explained;
  for (int i = 0; i < times; ++i) {
    std::vector<Burst> ended;
    for (const std::uint8_t transmitter : transmitters) {
      ended.push_back(burst(transmitter, 200 * i));
    }
    queue.push(ended, at(200 * i));
    ++explained[queue.pop().transmitter.octets[5]];
  }
  return explained;
}

TEST(BurstQueue, UnderLoadTheRatesOfOneRankFallAlike) {
  for (const std::uint8_t first : {std::uint8_t{10}, std::uint8_t{20}}) {
    const auto explained = explained_under_load(
        {first, std::uint8_t(first + 1), std::uint8_t(first + 2), std::uint8_t(first + 3)}, 100);
    ASSERT_EQ(explained.size(), 4U);
    for (const auto& [transmitter, bursts] : explained) {
      EXPECT_EQ(bursts, 25) << transmitter;
    }
  }
}

TEST(BurstQueue, UnderLoadEveryDeviceIsServed) {
  const auto explained = explained_under_load({1, 2, 10, 11, 20, 21, 22}, 640);
  EXPECT_EQ(explained.at(1), 240);  // three of four, in turn
  EXPECT_EQ(explained.at(2), 240);
  EXPECT_EQ(explained.at(10), 60);  // three of four of the rest
  EXPECT_EQ(explained.at(11), 60);
  for (const int stranger : {20, 21, 22}) {
    EXPECT_GE(explained.at(stranger), 13) << stranger;
  }
}

TEST(BurstQueue, ListedDevicesWithATrackPrecedeListedAcquisitions) {
  BurstQueue queue(ranked());
  push(queue, {burst(5, 0), burst(20, 10), burst(10, 20), burst(1, 30), burst(2, 40)});
  EXPECT_EQ(pop_all(queue), (std::vector{1, 2, 5, 10, 20}));
}

TEST(BurstQueue, EachRankLeavesEveryFourthPlaceToTheNext) {
  const auto explained = explained_under_load({1, 5, 10, 20}, 640);
  EXPECT_EQ(explained, (std::map<int, int>{{1, 480}, {5, 120}, {10, 30}, {20, 10}}));
}

TEST(BurstQueue, ListedDevicesAreTakenTogetherAndUnlistedAlone) {
  BurstQueue queue(ranked());
  push(queue, {burst(1, 0), burst(2, 0), burst(3, 0), burst(10, 0)});
  EXPECT_EQ(queue.pop(3).size(), 3U);
  EXPECT_EQ(queue.pop(3).size(), 1U);
  push(queue, {burst(20, 200), burst(21, 200)});
  EXPECT_EQ(queue.pop(3).size(), 1U);
  EXPECT_EQ(queue.size(), 1U);
}

TEST(BurstQueue, EveryFourthPlaceOfTheLastRankGoesToTheNewestThatWasNotServed) {
  BurstQueue queue(ranked());
  std::vector<Burst> ended;
  for (std::uint8_t stranger = 20; stranger < 40; ++stranger) {
    ended.push_back(burst(stranger, 10 * stranger));
  }
  push(queue, std::move(ended));
  std::vector<int> order;
  for (int i = 0; i < 5; ++i) {
    order.push_back(queue.pop().transmitter.octets[5]);
  }
  EXPECT_EQ(order, (std::vector{20, 21, 22, 39, 23}));
  // It has the newest burst again, and was served lately.
  push(queue, {burst(39, 500)}, at(650));
  order.clear();
  for (int i = 0; i < 4; ++i) {
    order.push_back(queue.pop().transmitter.octets[5]);
  }
  EXPECT_EQ(order, (std::vector{24, 25, 38, 26}));
}

// They may have left; a transmitter that continues has a newer burst.
TEST(Field, BurstQueueTakesOldBurstsOfTheLastRankAfterTheOthers) {
  BurstQueue queue(ranked());
  push(queue, {burst(20, 0), burst(21, 0), burst(10, 0)});
  push(queue, {burst(21, 600), burst(22, 600), burst(23, 650)}, at(800));
  EXPECT_EQ(pop_all(queue), (std::vector{10, 21, 22, 23, 20}));
  EXPECT_EQ(queue.dropped_bursts(), 0U);
}

// 200 addresses a second with one burst each, eight transmitters that continue and eight that send
// every five seconds; there is time for 20 bursts a second. Bursts of a transmitter, in 100 s.
std::map<int, int> explained_in_a_flood(std::uint64_t& of_flood) {
  BurstQueue queue(ranked());
  std::map<int, int> explained;
  std::uint32_t address = 0;
  for (int ms = 0; ms < 100'000; ms += 50) {
    std::vector<Burst> ended;
    for (int i = 0; i < 8; ++i) {
      if (ms % 200 == i % 4 * 50) {
        ended.push_back(burst(static_cast<std::uint8_t>(20 + i), ms));
      }
      if (ms % 5000 == i * 600) {
        ended.push_back(burst(static_cast<std::uint8_t>(30 + i), ms));
      }
    }
    for (int i = 0; i < 10; ++i, ++address) {
      ended.push_back(burst(200, ms));
      ended.back().transmitter.octets[3] = static_cast<std::uint8_t>(address >> 8U);
      ended.back().transmitter.octets[4] = static_cast<std::uint8_t>(address);
      ended.back().transmitter.octets[0] = 2;
    }
    queue.push(ended, at(ms + 150));
    const Burst taken = queue.pop();
    if (taken.transmitter.octets[5] == 200) {
      ++of_flood;
    } else {
      ++explained[taken.transmitter.octets[5]];
    }
    EXPECT_LE(at(ms + 150) - taken.last, milliseconds(500)) << ms;
  }
  return explained;
}

TEST(Field, BurstQueueServesThoseWhoStayAlikeInAFloodOfAddresses) {
  std::uint64_t of_flood = 0;
  const auto explained = explained_in_a_flood(of_flood);
  int least = std::numeric_limits<int>::max();
  int most = 0;
  for (int transmitter = 20; transmitter < 28; ++transmitter) {
    ASSERT_EQ(explained.count(transmitter), 1U) << transmitter;
    least = std::min(least, explained.at(transmitter));
    most = std::max(most, explained.at(transmitter));
  }
  EXPECT_GE(least, 100) << "one a second";
  EXPECT_LE(most, least + least / 10);
  EXPECT_GT(of_flood, 100U);
}

TEST(Field, BurstQueueDropsAndCountsExpiredBursts) {
  BurstQueue queue(ranked());
  push(queue, {burst(20, 0), burst(1, 0), burst(2, 500)}, at(3150));
  EXPECT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue.dropped_bursts(), 0U);
  push(queue, {}, at(3151));
  EXPECT_EQ(queue.dropped_bursts(), 2U);
  EXPECT_EQ(queue.dropped_frames(), 8U);
  EXPECT_EQ(queue.frames(), 4U);
  // A burst that continues is not old, however long it has waited for its turn.
  push(queue, {burst(2, 3000)}, at(6000));
  EXPECT_EQ(pop_all(queue), (std::vector{2}));
  EXPECT_EQ(queue.dropped_bursts(), 2U);
  EXPECT_EQ(queue.merged_bursts(), 1U);
  // The next burst of a dropped transmitter begins anew.
  push(queue, {burst(1, 6000)}, at(6200));
  EXPECT_EQ(queue.pop().received_since, at(6000));
}

TEST(Field, BurstQueueHoldsABoundedNumberOfFrames) {
  BurstQueueOptions options = ranked();
  options.max_frames = 12;  // of three bursts
  BurstQueue queue(options);
  push(queue, {burst(20, 0), burst(1, 10), burst(21, 20), burst(10, 30), burst(22, 40)});
  EXPECT_EQ(queue.frames(), 12U);
  EXPECT_EQ(queue.dropped_bursts(), 2U);
  EXPECT_EQ(queue.dropped_frames(), 8U);
  EXPECT_EQ(pop_all(queue), (std::vector{1, 10, 20}));
  // Old bursts of the last rank are dropped first.
  push(queue, {burst(20, 0), burst(21, 1000), burst(22, 1000), burst(23, 1000)}, at(1150));
  EXPECT_EQ(pop_all(queue), (std::vector{21, 22, 23}));
}

TEST(BurstQueue, CountsEveryBurstInOneRank) {
  BurstQueueOptions options = ranked();
  options.max_frames = 16;  // of four bursts
  BurstQueue queue(options);
  push(queue, {burst(1, 0), burst(5, 0), burst(10, 0), burst(20, 0), burst(21, 10)});
  push(queue, {burst(5, 200), burst(10, 200)}, at(350));
  EXPECT_EQ(queue.pop(2).size(), 2U);
  const std::array<RankCounts, kRanks>& counts = queue.by_rank();
  const auto expect = [](const RankCounts& counted, const std::vector<std::uint64_t>& numbers) {
    EXPECT_EQ((std::vector{counted.taken, counted.merged, counted.dropped, counted.waiting}),
              numbers);
    EXPECT_EQ(counted.ended(), std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0}));
  };
  expect(counts[0], {1, 0, 0, 0});
  expect(counts[1], {1, 1, 0, 0});
  expect(counts[2], {0, 1, 0, 1});
  expect(counts[3], {0, 0, 1, 1});
  EXPECT_EQ(queue.merged_bursts(), 2U);
  EXPECT_EQ(queue.dropped_bursts(), 1U);
}

TEST(BurstQueue, ADroppedBurstLeavesItsTurnToTheNext) {
  BurstQueueOptions options = ranked();
  options.max_frames = 8;  // of two bursts
  BurstQueue queue(options);
  push(queue, {burst(10, 0), burst(11, 0), burst(12, 0)});
  EXPECT_EQ(queue.dropped_bursts(), 1U);
  EXPECT_EQ(queue.pop().transmitter.octets[5], 10);
  push(queue, {burst(10, 200), burst(11, 200), burst(12, 200)}, at(350));
  EXPECT_EQ(queue.dropped_bursts(), 2U) << "the one that was served last";
  for (const MacAddress& transmitter :
       {MacAddress{{0, 0, 0, 0, 0, 10}}, {{0, 0, 0, 0, 0, 11}}, {{0, 0, 0, 0, 0, 12}}}) {
    EXPECT_TRUE(queue.is_waiting(transmitter)) << to_string(transmitter);
  }
  EXPECT_EQ(queue.pop().transmitter.octets[5], 11);
  const Burst kept = queue.pop();
  EXPECT_EQ(kept.transmitter.octets[5], 12);
  EXPECT_EQ(kept.received_since, at(0)) << "it has been received since its dropped burst";
  EXPECT_FALSE(queue.is_waiting({{0, 0, 0, 0, 0, 12}}));
  // A transmitter that falls silent loses its turn.
  push(queue, {burst(1, 10'000)}, at(10'000));
  EXPECT_FALSE(queue.is_waiting({{0, 0, 0, 0, 0, 10}}));
  push(queue, {burst(11, 10'000), burst(10, 10'000)}, at(10'000));
  EXPECT_EQ(pop_all(queue), (std::vector{1, 11}));
}

TEST(BurstQueue, ClearDropsBurstsAndTurns) {
  BurstQueueOptions options = ranked();
  options.max_frames = 8;  // of two bursts
  BurstQueue queue(options);
  push(queue, {burst(10, 10'000), burst(11, 10'000), burst(12, 10'000)}, at(10'150));
  EXPECT_EQ(queue.dropped_bursts(), 1U);
  EXPECT_TRUE(queue.is_waiting({{0, 0, 0, 0, 0, 12}})) << "dropped, and its next burst may follow";
  queue.clear();
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.frames(), 0U);
  EXPECT_EQ(queue.dropped_bursts(), 3U);
  EXPECT_EQ(queue.dropped_frames(), 12U);
  const RankCounts& tracked = queue.by_rank()[static_cast<std::size_t>(Rank::kTracked)];
  EXPECT_EQ(tracked.dropped, 3U);
  EXPECT_EQ(tracked.ended(), 3U);
  EXPECT_FALSE(queue.is_waiting({{0, 0, 0, 0, 0, 11}}));
  EXPECT_FALSE(queue.is_waiting({{0, 0, 0, 0, 0, 12}}));
  // Later bursts may be earlier in time.
  push(queue, {burst(11, 0), burst(12, 0)}, at(150));
  EXPECT_EQ(queue.pop().transmitter.octets[5], 11);
  EXPECT_EQ(queue.pop().received_since, at(0));
}

TEST(BurstQueue, AStrangerDoesNotDisplaceTheOnlyListedDevice) {
  BurstQueueOptions options = ranked();
  options.max_frames = 4;  // of one burst
  BurstQueue queue(options);
  push(queue, {burst(20, 0), burst(1, 10)});
  EXPECT_EQ(pop_all(queue), (std::vector{1}));
}

// Four ranks of 250 transmitters each, or 1,000 of one rank, all of which have a new burst in each
// step. More frames wait than may. Returns the number of bursts that each got.
std::map<std::uint64_t, int> explained_of_thousand(const RankOf& rank, int steps) {
  BurstQueueOptions options;
  options.rank = rank;
  options.max_frames = 2048;
  BurstQueue queue(options);
  std::map<std::uint64_t, int> explained;
  for (int step = 0; step < steps; ++step) {
    std::vector<Burst> ended;
    for (int i = 0; i < 1000; ++i) {
      ended.push_back(burst(static_cast<std::uint8_t>(i % 250), 200 * step));
      ended.back().transmitter.octets[4] = static_cast<std::uint8_t>(i / 250);
    }
    queue.push(ended, at(200 * step + 150));
    for (int i = 0; i < 7; ++i) {
      const Burst burst = queue.pop();
      ++explained[burst.transmitter.octets[4] * 250U + burst.transmitter.octets[5]];
    }
  }
  return explained;
}

TEST(Field, BurstQueueServesAThousandTransmittersOfOneRankAlike) {
  for (const Rank rank : {Rank::kTracked, Rank::kOther}) {
    const auto explained = explained_of_thousand([&](const MacAddress&) { return rank; }, 300);
    ASSERT_EQ(explained.size(), 1000U);
    for (const auto& [transmitter, bursts] : explained) {
      EXPECT_GE(bursts, 2) << transmitter;
      EXPECT_LE(bursts, 3) << transmitter;
    }
  }
}

TEST(Field, BurstQueueServesEveryRankOfAThousandTransmitters) {
  constexpr int kSteps = 320;
  const auto explained = explained_of_thousand(
      [](const MacAddress& transmitter) { return static_cast<Rank>(transmitter.octets[4]); },
      kSteps);
  std::array<int, kRanks> of_rank{};
  for (const auto& [transmitter, bursts] : explained) {
    of_rank.at(transmitter / 250) += bursts;
  }
  EXPECT_EQ(of_rank[0], 7 * kSteps * 3 / 4);
  for (std::size_t rank = 0; rank + 1 < kRanks; ++rank) {
    EXPECT_GT(of_rank.at(rank + 1), of_rank.at(rank) / 5) << rank;
    EXPECT_LT(of_rank.at(rank + 1), of_rank.at(rank)) << rank;
  }
}

}  // namespace
}  // namespace rayloc::burst_queue_test
