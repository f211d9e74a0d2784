#include "engine/chains/reference_chains.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "engine/room/preprocess_burst.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::reference_chains_test {
namespace {

const MacAddress kPlug{{0x02, 0, 0, 0, 0, 7}};
constexpr double kPhase = 1.8;  // [rad], of the last chain after the power cycle

const std::shared_ptr<const RoomModel>& room() {
  static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
  return kRoom;
}

std::vector<CsiFrame> frames_of_plug(double phase, unsigned seed) {
  auto frames =
      test::frames_at(*room(), {1.1, -0.8, 1.2}, {.count = 8, .snr_db = 30.0, .seed = seed});
  test::turn_chain(frames, 0, room()->access_points[0].rx_chains[2], phase);
  return frames;
}

ChainState state_of(ChainKnowledge knowledge, double phase) {
  ChainState state;
  state.knowledge = knowledge;
  state.factors = ChainFactors::unity(3);
  state.factors.factor[2] = std::polar(1.0, phase);
  return state;
}
const std::vector<ChainState> kLearned{state_of(ChainKnowledge::kLearned, kPhase)};

// With the reference of an empty room in which the chain had this phase.
ReferenceChains recorded(double phase) {
  ReferenceChains chains(room());
  std::vector<std::string> warnings;
  chains.add(kPlug, 0, preprocess_burst(*room(), 0, frames_of_plug(phase, 9), {}, warnings)->h);
  return chains;
}

TEST(ReferenceChains, AReferenceOfTheCalibrationContainsNoFactors) {
  ReferenceChains chains = recorded(0.0);
  EXPECT_FALSE(chains.contains_factors(kPlug, 0)) << "no burst yet";
  chains.observe(kPlug, frames_of_plug(kPhase, 1), kLearned);
  EXPECT_FALSE(chains.contains_factors(kPlug, 0));
  chains.observe(kPlug, frames_of_plug(0.0, 2), kLearned);
  EXPECT_FALSE(chains.contains_factors(kPlug, 0)) << "another power cycle, not another reference";
  EXPECT_FALSE(chains.contains_factors(kPlug, 1)) << "a link without reference";
}

TEST(ReferenceChains, AReferenceAfterThePowerCycleContainsTheFactors) {
  ReferenceChains chains = recorded(kPhase);
  chains.observe(kPlug, frames_of_plug(kPhase, 1), kLearned);
  EXPECT_TRUE(chains.contains_factors(kPlug, 0));
  const std::vector<ChainState> learning{state_of(ChainKnowledge::kLearning, kPhase)};
  chains.observe(kPlug, frames_of_plug(0.0, 2), learning);
  EXPECT_TRUE(chains.contains_factors(kPlug, 0)) << "kept while chains are being learned";
  chains.restart();
  EXPECT_FALSE(chains.contains_factors(kPlug, 0));
}

TEST(ReferenceChains, FactorsThatWereWrongAreInNoReference) {
  ReferenceChains chains = recorded(0.0);
  chains.observe(kPlug, frames_of_plug(0.0, 1), kLearned);
  EXPECT_TRUE(chains.contains_factors(kPlug, 0)) << "the chains are as calibrated again";
  const std::vector<ChainState> small{state_of(ChainKnowledge::kLearned, 0.1)};
  chains.observe(kPlug, frames_of_plug(0.0, 2), small);
  EXPECT_FALSE(chains.contains_factors(kPlug, 0));
}

TEST(ReferenceChains, AnUnclearBurstDecidesNothing) {
  ReferenceChains chains = recorded(kPhase);
  auto others = frames_of_plug(kPhase + 2.2, 1);  // fits neither way
  test::turn_chain(others, 0, room()->access_points[0].rx_chains[1], 2.0);
  chains.observe(kPlug, others, kLearned);
  EXPECT_FALSE(chains.contains_factors(kPlug, 0));
  chains.observe(kPlug, frames_of_plug(kPhase, 2), kLearned);
  EXPECT_TRUE(chains.contains_factors(kPlug, 0));
}

}  // namespace
}  // namespace rayloc::reference_chains_test
