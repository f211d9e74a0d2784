#include "daemon/live/cluster/sequencer.h"

#include <algorithm>
#include <deque>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/numbered_ring.h"
#include "tests/daemon/live/cluster/some_batch.h"

namespace rayloc::sequencer_test {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kNode = "node1";
constexpr const char* kAp = "ap1";

Batch numbered(std::uint64_t number,
               std::vector<BatchGap> gaps = {},
               std::uint64_t epoch = kSomeEpoch) {
  Batch batch = some_batch(number, {}, epoch);
  batch.gaps = std::move(gaps);
  batch.oldest_kept = 100;
  return batch;
}

std::vector<std::uint64_t> push(Sequencer& sequencer,
                                Batch batch,
                                const std::string& node = kNode) {
  std::vector<Sequencer::Taken> out;
  sequencer.push(node, std::move(batch), out);
  std::vector<std::uint64_t> numbers;
  for (const Sequencer::Taken& taken : out) {
    numbers.push_back(taken.batch.number);
  }
  const Sequencer::Counters counters = sequencer.counters();
  EXPECT_EQ(counters.pushed, counters.taken + counters.repeats + counters.late + counters.held);
  return numbers;
}

TEST(Sequencer, TakesEachOnceAndInOrder) {
  Sequencer sequencer({}, true);
  EXPECT_THAT(push(sequencer, numbered(1)), ElementsAre(1));
  EXPECT_THAT(push(sequencer, numbered(3)), IsEmpty());
  EXPECT_THAT(push(sequencer, numbered(4)), IsEmpty());
  EXPECT_THAT(push(sequencer, numbered(4)), IsEmpty());
  EXPECT_THAT(sequencer.holes(), ElementsAre(Sequencer::Hole{kNode, kSomeEpoch, 2, 2}));
  EXPECT_THAT(push(sequencer, numbered(2)), ElementsAre(2, 3, 4));
  EXPECT_THAT(push(sequencer, numbered(2)), IsEmpty());
  EXPECT_THAT(sequencer.holes(), IsEmpty());
  EXPECT_EQ(sequencer.counters().repeats, 2U);
}

TEST(Sequencer, NodesDoNotWaitForEachOther) {
  Sequencer sequencer({}, true);
  EXPECT_THAT(push(sequencer, numbered(2), "a"), IsEmpty());
  EXPECT_THAT(push(sequencer, numbered(1), "b"), ElementsAre(1));
}

TEST(Sequencer, AMarkReplacesMissingBatches) {
  Sequencer sequencer({}, true);
  EXPECT_THAT(push(sequencer, numbered(5, {{1, 2, {{kAp, 7}}, "x"}, {4, 4, {{kAp, 1}}, "y"}})),
              IsEmpty());
  EXPECT_THAT(sequencer.holes(), ElementsAre(Sequencer::Hole{kNode, kSomeEpoch, 3, 3}));
  EXPECT_EQ(sequencer.counters().marked, 2U);
  EXPECT_THAT(push(sequencer, numbered(3)), ElementsAre(3, 5));
  EXPECT_EQ(sequencer.counters().marked, 3U);
  EXPECT_EQ(sequencer.counters().marked_datagrams.at(kAp), 8U);
  EXPECT_THAT(push(sequencer, numbered(4)), IsEmpty());  // after all
  EXPECT_EQ(sequencer.counters().missing, 0U);
}

TEST(Sequencer, ANewNodeEpochEndsHolesAndDropsLateBatchesOfTheOldOne) {
  Sequencer sequencer({}, true);
  EXPECT_THAT(push(sequencer, numbered(2)), IsEmpty());
  EXPECT_THAT(push(sequencer, numbered(2, {}, 99)), ElementsAre(2));  // of the old one
  EXPECT_EQ(sequencer.counters().missing, 1U);
  EXPECT_THAT(push(sequencer, numbered(1)), IsEmpty());
  EXPECT_EQ(sequencer.counters().late, 1U);
  EXPECT_THAT(push(sequencer, numbered(1, {}, 99)), ElementsAre(1, 2));
  EXPECT_THAT(sequencer.positions().at(kNode).past_epochs, ElementsAre(kSomeEpoch));
}

TEST(Sequencer, GoesOnFromPositions) {
  Sequencer sequencer({{kNode, {kSomeEpoch, 41, {3}}}}, false);
  EXPECT_THAT(push(sequencer, numbered(41)), IsEmpty());
  EXPECT_THAT(push(sequencer, numbered(7, {}, 3)), IsEmpty());
  EXPECT_THAT(push(sequencer, numbered(42)), ElementsAre(42));
  EXPECT_THAT(push(sequencer, numbered(9), "stranger"),
              ElementsAre(9));  // what was before is not missed
}

TEST(Sequencer, BoundsTheHeldBatches) {
  Sequencer sequencer({}, true);
  for (std::uint64_t number = 2; number < 10'000; ++number) {
    push(sequencer, numbered(number));
  }
  EXPECT_LE(sequencer.counters().held, 4096U);
  EXPECT_EQ(sequencer.counters().missing, 1U);
}

// A capture node, and a stream that loses, repeats and reorders: the reader requests missing
// batches, and takes every batch once and in order, except those that are marked.
class LossyLink : public ::testing::TestWithParam<unsigned> {};

TEST_P(LossyLink, EveryDatagramIsTakenOrMarked) {
  std::mt19937 random(GetParam());
  const auto any = [&](std::uint64_t most) { return random() % (most + 1); };
  NumberedRing::Limits limits;
  limits.keep = milliseconds(1500);
  limits.stale = milliseconds(120);
  limits.patience = milliseconds(200);
  NumberedRing ring(kSomeEpoch, limits);
  Sequencer sequencer({}, true);
  std::vector<Sequencer::Taken> taken;
  std::deque<std::string> in_transit;
  NumberedRing::Time now{std::chrono::seconds(100)};
  const auto round = [&](bool is_broken, std::uint64_t datagrams) {
    now += milliseconds(20);
    ring.add(some_batch(1, {{kAp, datagrams}}), now);
    ring.tend(now);
    for (bool is_away = is_broken && any(3) == 0; !is_away;) {
      const auto one = ring.next(now);
      if (!one) {
        break;
      }
      const std::uint64_t fate = is_broken ? any(9) : 9;
      if (fate != 0) {
        in_transit.push_back(*one->bytes);
      }
      if (fate == 1) {
        in_transit.push_back(*one->bytes);
      }
      if (fate != 2) {  // with 0 the broker has lost what it acknowledged
        ring.acknowledged(one->number);
      }
    }
    if (is_broken) {
      std::shuffle(in_transit.begin(), in_transit.end(), random);
    }
    for (std::uint64_t i = is_broken ? any(30) : in_transit.size(); i > 0 && !in_transit.empty();
         --i) {
      sequencer.push(kNode, *decode_batch(in_transit.front()), taken);
      in_transit.pop_front();
    }
    for (const Sequencer::Hole& hole : sequencer.holes()) {
      if (!is_broken || any(19) == 0) {
        ring.ask(hole.from, hole.to);
      }
    }
  };
  for (int i = 0; i < 1000; ++i) {
    round(true, any(5));
  }
  for (int i = 0; i < 300; ++i) {
    round(false, 0);
  }
  EXPECT_THAT(sequencer.holes(), IsEmpty());
  std::uint64_t before = 0;
  std::uint64_t datagrams = 0;
  for (const Sequencer::Taken& one : taken) {
    EXPECT_GT(one.batch.number, before);
    before = one.batch.number;
    for (const BatchPart& part : one.batch.parts) {
      datagrams += part.datagrams.entries.size();
    }
  }
  const Sequencer::Counters counters = sequencer.counters();
  EXPECT_EQ(counters.missing, 0U);
  EXPECT_EQ(counters.taken + counters.marked, ring.counters().batches);
  EXPECT_GT(counters.repeats, 0U);
  const auto marked = counters.marked_datagrams.find(kAp);
  EXPECT_EQ(datagrams + (marked == counters.marked_datagrams.end() ? 0 : marked->second),
            ring.counters().added.at(kAp));
}

INSTANTIATE_TEST_SUITE_P(Seeds, LossyLink, ::testing::Range(1U, 9U));

// Readers of the same records take the same batches.
TEST(Sequencer, GivesTheSameOutputForTheSameRecords) {
  std::mt19937 random(3);
  std::vector<Batch> records;
  for (int i = 0; i < 3000; ++i) {
    records.push_back(numbered(1 + random() % 400, {}, 70 + static_cast<unsigned>(i) / 1000));
  }
  const auto all = [&] {
    Sequencer sequencer({}, true);
    std::vector<std::uint64_t> numbers;
    for (const Batch& batch : records) {
      for (const std::uint64_t number : push(sequencer, batch)) {
        numbers.push_back(number);
      }
    }
    return numbers;
  };
  EXPECT_EQ(all(), all());
  EXPECT_GT(all().size(), 300U);
}

}  // namespace
}  // namespace rayloc::sequencer_test
