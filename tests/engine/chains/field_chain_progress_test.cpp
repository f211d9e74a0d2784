// The text that users read while receive chains are being learned.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/chains/chain_progress.h"

namespace rayloc::field_chain_progress_test {
namespace {

using ::testing::HasSubstr;

TEST(Field, ProgressOfLearningListsTheRequirements) {
  ChainState state;
  state.knowledge = ChainKnowledge::kLearning;
  state.bursts = 4;
  EXPECT_THAT(progress_text(state), HasSubstr("4 of at least 10 bursts"));
  state.bursts = 12;
  state.evidence = 3.14;
  EXPECT_THAT(progress_text(state), HasSubstr("12 bursts, evidence 3.1 of 7.0"));
  state.evidence = 6.99;
  EXPECT_THAT(progress_text(state), HasSubstr("6.9 of 7.0"))
      << "what is not reached is not rounded";
  state.evidence = 30.0;
  state.phase_sigma = 0.5;
  EXPECT_THAT(progress_text(state), HasSubstr("phases to 29 degrees, 20 needed"));
}

}  // namespace
}  // namespace rayloc::field_chain_progress_test
