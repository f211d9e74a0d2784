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
std::vector<ChainState> learned(double phase, bool is_confirmed = true) {
  std::vector<ChainState> states{state_of(ChainKnowledge::kLearned, phase)};
  states[0].is_confirmed = is_confirmed;
  return states;
}

// With the reference of an empty room in which the chain had this phase.
ReferenceChains recorded(double phase) {
  ReferenceChains chains(room());
  std::vector<std::string> warnings;
  chains.add(kPlug, 0, preprocess_burst(*room(), 0, frames_of_plug(phase, 9), {}, warnings)->h);
  return chains;
}

bool contains_factors(const ReferenceChains& chains, std::size_t access_point = 0) {
  return !chains.recorded(kPlug, access_point).empty();
}

TEST(ReferenceChains, AReferenceOfTheCalibrationContainsNoFactors) {
  ReferenceChains chains = recorded(0.0);
  EXPECT_FALSE(contains_factors(chains)) << "no burst yet";
  EXPECT_TRUE(chains.is_undecided(kPlug, 0));
  chains.observe(kPlug, frames_of_plug(kPhase, 1), learned(kPhase, false));
  EXPECT_FALSE(contains_factors(chains));
  EXPECT_FALSE(chains.is_undecided(kPlug, 0)) << "the array confirms the factors";
  chains.observe(kPlug, frames_of_plug(0.0, 2), learned(kPhase));
  EXPECT_FALSE(contains_factors(chains)) << "another power cycle, not another reference";
  EXPECT_FALSE(contains_factors(chains, 1)) << "a link without reference";
  EXPECT_FALSE(chains.is_undecided(kPlug, 1));
}

TEST(ReferenceChains, AReferenceAfterThePowerCycleContainsTheFactors) {
  ReferenceChains chains = recorded(kPhase);
  chains.observe(kPlug, frames_of_plug(kPhase, 1), learned(kPhase));
  const auto factors = learned(kPhase)[0].factors.factor;
  EXPECT_EQ(chains.recorded(kPlug, 0), factors);
  const std::vector<ChainState> learning{state_of(ChainKnowledge::kLearning, kPhase)};
  chains.observe(kPlug, frames_of_plug(0.0, 2), learning);
  EXPECT_EQ(chains.recorded(kPlug, 0), factors) << "kept while chains are being learned";
  chains.observe(kPlug, frames_of_plug(kPhase + 2.0, 3), learned(kPhase + 2.0));
  EXPECT_EQ(chains.recorded(kPlug, 0), factors) << "those of the recording, not the last ones";
  EXPECT_EQ(chains.presumed(kPlug, 0), factors);
  chains.restart();
  EXPECT_FALSE(contains_factors(chains));
  EXPECT_TRUE(chains.is_undecided(kPlug, 0));
}

TEST(ReferenceChains, FactorsOfAnEarlierRunDecideNothing) {
  ReferenceChains chains = recorded(0.0);
  chains.observe(kPlug, frames_of_plug(0.0, 1), learned(kPhase, false));
  EXPECT_FALSE(contains_factors(chains)) << "the chains are as calibrated again";
  EXPECT_TRUE(chains.is_undecided(kPlug, 0));
  EXPECT_FALSE(chains.presumed(kPlug, 0).empty()) << "the frames fit as received";
  const std::vector<ChainState> learning{state_of(ChainKnowledge::kLearning, kPhase)};
  chains.observe(kPlug, frames_of_plug(0.0, 2), learning);
  EXPECT_TRUE(chains.presumed(kPlug, 0).empty());
}

TEST(ReferenceChains, FactorsThatWereWrongAreInNoReference) {
  ReferenceChains chains = recorded(0.0);
  chains.observe(kPlug, frames_of_plug(0.0, 1), learned(kPhase));
  EXPECT_TRUE(contains_factors(chains)) << "confirmed, but before a power cycle";
  chains.observe(kPlug, frames_of_plug(0.0, 2), learned(0.1));
  EXPECT_FALSE(contains_factors(chains));
  EXPECT_TRUE(chains.presumed(kPlug, 0).empty());
}

TEST(ReferenceChains, AnUnclearBurstDecidesNothing) {
  ReferenceChains chains = recorded(kPhase);
  auto others = frames_of_plug(kPhase + 2.2, 1);  // fits neither way
  test::turn_chain(others, 0, room()->access_points[0].rx_chains[1], 2.0);
  chains.observe(kPlug, others, learned(kPhase));
  EXPECT_TRUE(chains.is_undecided(kPlug, 0));
  chains.observe(kPlug, frames_of_plug(kPhase, 2), learned(kPhase));
  EXPECT_TRUE(contains_factors(chains));
}

}  // namespace
}  // namespace rayloc::reference_chains_test
