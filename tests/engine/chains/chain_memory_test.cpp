#include "engine/chains/chain_memory.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <utility>

namespace rayloc::chain_memory_test {
namespace {

constexpr std::size_t kChains = 3;

Timestamp at(int second) { return Timestamp() + std::chrono::seconds(second); }

// Remembers a burst every second, from `first` on.
void remember(ChainMemory& memory, int first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    RememberedBurst burst;
    burst.time = at(first + static_cast<int>(i));
    memory.remember(std::move(burst));
  }
}

// The mean of a beta distribution of weight 1: 0.3 / (1 + n) after n harmless silences.
TEST(ChainMemory, HarmlessSilencesMakeTheNextLessSuspect) {
  const double near = ChainBelief(kChains, 1.0).as_accepted();  // by chance
  ChainMemory memory(kChains, 0.0);
  memory.settle();
  for (int n = 0; n < 60; ++n) {
    memory.suspect_after_silence(at(60 * n));
    const double rotated = n < 30 ? 0.3 / (1 + n) : 0.01;
    EXPECT_NEAR(1.0 - memory.belief.as_accepted(), rotated * (1.0 - near), 2e-4) << n;
    EXPECT_TRUE(memory.confirm_since(at(60 * n - 1)));
    EXPECT_FALSE(memory.confirm_since(at(60 * n - 1)));
  }
  memory.give_up();
  memory.suspect_after_silence(at(3600));
  EXPECT_NEAR(1.0 - memory.belief.as_accepted(), 0.3 * (1.0 - near), 2e-4);
}

// The bursts between two silences are no evidence on the chains after the second.
TEST(ChainMemory, ConfirmsOnlySilencesThatEnoughBurstsFollow) {
  ChainMemory memory(kChains, 0.0);
  memory.settle();
  remember(memory, 0, 4);
  EXPECT_EQ(memory.bursts_since_silence().size(), 4U);
  memory.suspect_after_silence(at(100));
  remember(memory, 100, 12);
  EXPECT_EQ(memory.bursts_since_silence().size(), 12U);
  memory.suspect_after_silence(at(200));
  remember(memory, 200, kChainBurstsNeeded - 1);
  EXPECT_EQ(memory.bursts_since_silence().size(), 12U + kChainBurstsNeeded - 1);
  memory.confirm_silences();
  ASSERT_EQ(memory.silences.size(), 1U);
  EXPECT_EQ(memory.silences.front().end, at(200));
  EXPECT_LT(memory.belief.as_accepted(), 0.9);
  memory.suspect_after_silence(at(300));
  remember(memory, 300, kChainBurstsNeeded);
  EXPECT_EQ(memory.bursts_since_silence().size(), kChainBurstsNeeded);
  EXPECT_EQ(memory.bursts_since_silence().front().time, at(300));
  memory.confirm_silences();
  EXPECT_TRUE(memory.silences.empty());
  EXPECT_GT(memory.belief.as_accepted(), ChainMemory::kSure);
  EXPECT_EQ(memory.harmless_silences, 3U);
}

TEST(ChainMemory, ForgetsBurstsFromBeforeASilenceWithTheState) {
  ChainMemory memory(kChains, 0.0);
  remember(memory, 0, 4);
  memory.suspect_after_silence(at(100));
  remember(memory, 100, 2);
  memory.give_up();
  ASSERT_EQ(memory.received.size(), 2U);
  EXPECT_EQ(memory.received.front().time, at(100));
  EXPECT_TRUE(memory.silences.empty());
}

}  // namespace
}  // namespace rayloc::chain_memory_test
