#include "engine/chains/chain_learner.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "tests/support/faulty_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::chain_learner_test {
namespace {

using Value = std::complex<double>;

// The synthetic room with its first access point, which models it well.
std::shared_ptr<const Localizer> localizer() {
  static const std::shared_ptr<const Localizer> kLocalizer = [] {
    RoomModel room = test::make_room();
    room.access_points.resize(1);
    room.access_points[0].error.plan_tolerance = 0.001;
    room.access_points[0].error.diffuse = 0.005;
    auto made = Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
    return std::make_shared<const Localizer>(*std::move(made));
  }();
  return kLocalizer;
}

// A device somewhere else every two seconds. `noise`: seed.
std::vector<CsiFrame> burst(int number, unsigned noise) {
  std::mt19937 random(static_cast<unsigned>(number + 1));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double x = 1.2 * uniform(random);
  auto frames =
      test::frames_at(localizer()->room(), {x, 0.9 * uniform(random), 1.2}, {4, 30.0, noise});
  for (CsiFrame& frame : frames) {
    frame.time += std::chrono::seconds(2 * number);
  }
  return frames;
}

std::vector<CsiFrame> burst(int number) { return burst(number, static_cast<unsigned>(number + 1)); }

// Chains that multiply by these.
std::vector<CsiFrame> through(std::vector<CsiFrame> frames, const std::vector<Value>& factors) {
  const auto& rx_chains = localizer()->room().access_points[0].rx_chains;
  for (std::size_t m = 0; m < factors.size(); ++m) {
    for (CsiFrame& frame : frames) {
      for (std::size_t row = 0; row < frame.rx_chains.size(); ++row) {
        if (frame.rx_chains[row] == rx_chains[m]) {
          for (std::complex<float>& value : frame.csi.row(row, 0)) {
            value *= std::complex<float>(factors[m]);
          }
        }
      }
    }
  }
  return frames;
}

double phase_error(const ChainState& state, const std::vector<Value>& factors, std::size_t m) {
  return std::arg(state.factors.factor[m] / state.factors.factor[0] / (factors[m] / factors[0]));
}

TEST(ChainLearner, LeavesChainsAloneThatAreAsCalibrated) {
  ChainLearner learner(localizer());
  for (int i = 0; i < 20; ++i) {
    const auto frames = burst(i);
    learner.receive(frames);
    ASSERT_EQ(learner.states().size(), 1U);
    EXPECT_EQ(learner.states()[0].knowledge, ChainKnowledge::kAsCalibrated) << i;
    EXPECT_EQ(learner.accepted(frames).size(), frames.size());
    EXPECT_LT(learner.fault_of(frames).probability, i < 6 ? 0.6 : 0.05) << i;
  }
  EXPECT_TRUE(learner.leaves_alone());
  EXPECT_EQ(learner.withdrawals(), 0U);
}

// Any phases and gains: nothing is a quarter of a turn.
TEST(ChainLearner, LearnsTheChainFactorsAfterAPowerCycle) {
  const std::vector<std::vector<Value>> cycles = {
      {1.0, std::polar(1.2, 1.0), std::polar(0.9, -2.6)},
      {1.0, 1.0, std::polar(1.0, std::numbers::pi)}};
  for (const std::vector<Value>& factors : cycles) {
    ChainLearner learner(localizer());
    for (int i = 0; i < 24; ++i) {
      learner.receive(through(burst(i), factors));
    }
    const ChainState state = learner.states().at(0);
    ASSERT_EQ(state.knowledge, ChainKnowledge::kLearned);
    for (std::size_t m = 1; m < 3; ++m) {
      EXPECT_NEAR(phase_error(state, factors, m), 0.0, 0.3);
      EXPECT_LT(std::abs(phase_error(state, factors, m)), 4.0 * state.factors.sigma[m] + 0.02);
      EXPECT_NEAR(std::log(std::abs(state.factors.factor[m] / state.factors.factor[0] /
                                    (factors[m] / factors[0]))),
                  0.0,
                  0.2);
    }
    EXPECT_FALSE(learner.leaves_alone());
    // Frames are as if nothing had happened: a fix is where the device is.
    const auto frames = learner.accepted(through(burst(40), factors));
    const LocationEstimate as_before = localizer()->locate(burst(40));
    const LocationEstimate now = localizer()->locate(frames);
    ASSERT_TRUE(now.position && as_before.position);
    EXPECT_LT(norm(*now.position - *as_before.position), 0.2);
  }
}

TEST(ChainLearner, WithdrawsWrongFactorsAndLearnsAnew) {
  const std::vector<Value> first = {1.0, std::polar(1.0, 2.0), std::polar(1.0, -1.2)};
  const std::vector<Value> second = {1.0, std::polar(1.0, -1.0), std::polar(1.0, 0.8)};
  ChainLearner learner(localizer());
  for (int i = 0; i < 24; ++i) {
    learner.receive(through(burst(i), first));
  }
  ASSERT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kLearned);
  int withdrawn = -1;
  for (int i = 24; i < 64; ++i) {
    const auto frames = through(burst(i), second);
    learner.receive(frames);
    const bool is_learning = learner.states().at(0).knowledge == ChainKnowledge::kLearning;
    EXPECT_EQ(learner.accepted(frames).empty(), is_learning);
    if (withdrawn < 0 && std::abs(phase_error(learner.states().at(0), first, 1)) > 0.5) {
      withdrawn = i;
    }
  }
  const ChainState state = learner.states().at(0);
  EXPECT_EQ(state.knowledge, ChainKnowledge::kLearned);
  EXPECT_GT(withdrawn, 0);
  EXPECT_EQ(learner.withdrawals(), 2U);
  EXPECT_NEAR(phase_error(state, second, 1), 0.0, 0.3);
  EXPECT_NEAR(phase_error(state, second, 2), 0.0, 0.3);
}

// A device at one place that resembles another place with rotated chains is evidence once.
TEST(ChainLearner, RepeatedBurstsAddNoEvidence) {
  const std::vector<Value> factors = {1.0, 1.0, std::polar(1.0, 1.6)};
  ChainLearner learner(localizer());
  for (int i = 0; i < 30; ++i) {
    auto frames = burst(0);
    for (CsiFrame& frame : frames) {
      frame.time += std::chrono::seconds(2 * i);
    }
    learner.receive(through(frames, factors));
  }
  EXPECT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kAsCalibrated);
  EXPECT_LE(learner.states().at(0).bursts, 2U);
}

// The synthetic room with all of its access points, which model it as well.
std::shared_ptr<const Localizer> localizer_of_all() {
  static const std::shared_ptr<const Localizer> kLocalizer = [] {
    RoomModel room = test::make_room();
    for (RoomAccessPoint& ap : room.access_points) {
      ap.error = localizer()->room().access_points[0].error;
    }
    auto made = Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
    return std::make_shared<const Localizer>(*std::move(made));
  }();
  return kLocalizer;
}

// The access points receive each burst with frames of their own, the last one of the last access
// point.
std::vector<CsiFrame> burst_of_all(int place, int second) {
  std::mt19937 random(static_cast<unsigned>(place + 1));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double x = 1.2 * uniform(random);
  auto frames = test::frames_at(localizer_of_all()->room(),
                                {x, 0.9 * uniform(random), 1.2},
                                {4, 30.0, static_cast<unsigned>(1000 + second)});
  for (CsiFrame& frame : frames) {
    frame.time += std::chrono::seconds(second) + std::chrono::milliseconds(frame.access_point);
  }
  return frames;
}

// The fault of the frames of one access point.
double fault_of(const ChainLearner& learner,
                const std::vector<CsiFrame>& frames,
                std::size_t access_point) {
  std::vector<CsiFrame> own;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(own), [&](const CsiFrame& one) {
    return one.access_point == access_point;
  });
  return learner.fault_of(own).probability;
}

// A device at rest that transmits every 30 s, and nothing else: silences are no power cycles while
// its channel remains the same. With rotated chains it changes.
TEST(ChainLearner, ARepeatedBurstAfterASilenceConfirmsTheChains) {
  ChainLearner learner(localizer_of_all());
  const std::size_t count = localizer_of_all()->room().access_points.size();
  ASSERT_GT(count, 1U);
  for (int i = 0; i < 6; ++i) {
    learner.receive(burst_of_all(i, 2 * i));
  }
  std::vector<double> before;
  for (std::size_t a = 0; a < count; ++a) {
    before.push_back(fault_of(learner, burst_of_all(3, 10), a));
  }
  for (int i = 1; i <= 12; ++i) {
    const auto frames = burst_of_all(3, 10 + 30 * i);
    learner.receive(frames);
    for (std::size_t a = 0; a < count; ++a) {
      EXPECT_NEAR(fault_of(learner, frames, a), before[a], 0.01) << i << ' ' << a;
    }
  }
  const std::vector<Value> factors = {1.0, std::polar(1.0, 2.0), std::polar(1.0, -1.2)};
  double fault = 0.0;
  for (int i = 0; i < 8 && fault < 0.2; ++i) {
    const auto rotated = through(burst_of_all(3 + i, 600 + 2 * i), factors);
    learner.receive(rotated);
    fault = fault_of(learner, rotated, 0);
    EXPECT_GT(fault, 5.0 * before[0]) << i;
  }
  EXPECT_GT(fault, 0.2);
}

// Bursts from before a silence are no evidence on the chains after it: they would confirm the
// chains as calibrated, because they are more.
TEST(ChainLearner, BurstsBeforeASilenceDoNotConfirmTheChainsAfterIt) {
  const std::vector<std::vector<Value>> cycles = {
      {1.0, std::polar(1.0, 1.0), 1.0},
      {1.0, std::polar(1.0, 2.0), std::polar(1.0, -1.2)},
      {1.0, std::polar(1.0, 0.5), std::polar(1.0, -2.0)}};
  constexpr int kBefore = 24;
  for (std::size_t cycle = 0; cycle < cycles.size(); ++cycle) {
    ChainLearner learner(localizer_of_all());
    for (int i = 0; i < kBefore; ++i) {
      learner.receive(burst_of_all(i, 2 * i));
    }
    ASSERT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kAsCalibrated);
    for (int i = 0; i < 16; ++i) {
      const auto frames = through(burst_of_all(kBefore + i, 120 + 2 * i), cycles[cycle]);
      learner.receive(frames);
      if (learner.states().at(0).knowledge == ChainKnowledge::kAsCalibrated) {
        EXPECT_GT(fault_of(learner, frames, 0), 0.1) << cycle << ' ' << i;
        EXPECT_LT(i, 10) << cycle;
      }
    }
    ASSERT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kLearned) << cycle;
    for (std::size_t m = 1; m < 3; ++m) {
      EXPECT_NEAR(phase_error(learner.states().at(0), cycles[cycle], m), 0.0, 0.3) << cycle;
    }
  }
}

// A silence after which the bursts are as before: the chains are certain again.
TEST(ChainLearner, HarmlessSilencesLeaveTheChainsCertain) {
  ChainLearner learner(localizer());
  for (int i = 0; i < 60; ++i) {
    auto frames = burst(i);
    for (CsiFrame& frame : frames) {
      frame.time += i / 12 * std::chrono::minutes(1);
    }
    learner.receive(frames);
    ASSERT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kAsCalibrated) << i;
    if (i % 12 == 11) {
      EXPECT_LT(learner.fault_of(frames).probability, 0.002) << i;
    }
  }
}

// After a reported power cycle, no burst is used until the chains are learned, and the next program
// uses the learned chains.
TEST(ChainLearner, LearnsAfterAReportedPowerCycleAndKeepsTheResult) {
  const std::vector<Value> factors = {1.0, std::polar(1.1, 0.6), std::polar(1.0, 3.0)};
  ChainLearner learner(localizer());
  learner.power_cycled(0, burst(0).front().time);
  EXPECT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kLearning);
  EXPECT_TRUE(learner.accepted(burst(0)).empty());
  int bursts = 0;
  while (bursts < 40 && learner.states().at(0).knowledge != ChainKnowledge::kLearned) {
    learner.receive(through(burst(bursts++), factors));
  }
  ASSERT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kLearned);
  ChainLearner next(localizer());
  next.restore(learner.states().at(0));
  const auto frames = through(burst(50), factors);
  const auto kept = next.accepted(frames);
  ASSERT_EQ(kept.size(), frames.size());
  const LocationEstimate now = localizer()->locate(kept);
  const LocationEstimate as_before = localizer()->locate(burst(50));
  ASSERT_TRUE(now.position && as_before.position);
  EXPECT_LT(norm(*now.position - *as_before.position), 0.2);
  for (int i = 51; i < 60; ++i) {
    next.receive(through(burst(i), factors));
    EXPECT_EQ(next.states().at(0).knowledge, ChainKnowledge::kLearned) << i;
  }
}

// A program that ends while it learns, and the next one, need as many bursts as one program.
TEST(ChainLearner, ContinuesFromTheEvidenceOfAnEarlierRun) {
  const std::vector<Value> factors = {1.0, std::polar(1.1, 0.6), std::polar(1.0, 3.0)};
  const auto learns = [&](ChainLearner& learner, int begin) {
    int bursts = begin;
    while (bursts < 40 && learner.states().at(0).knowledge == ChainKnowledge::kLearning) {
      learner.receive(through(burst(bursts++), factors));
    }
    return bursts;
  };
  ChainLearner whole(localizer());
  whole.power_cycled(0, burst(0).front().time);
  EXPECT_FALSE(whole.record(0)) << "there is no evidence yet";
  const int needed = learns(whole, 0);
  ASSERT_EQ(whole.states().at(0).knowledge, ChainKnowledge::kLearned);
  EXPECT_FALSE(whole.record(0)) << "learned chains need no evidence";
  for (const int cut : {3, 7}) {
    ASSERT_LT(cut, needed);
    ChainLearner first(localizer());
    first.power_cycled(0, burst(0).front().time);
    for (int i = 0; i < cut; ++i) {
      first.receive(through(burst(i), factors));
    }
    ChainState state = first.states().at(0);
    ASSERT_TRUE(first.record(0));
    state.record = std::make_shared<const ChainRecord>(*first.record(0));
    ChainLearner next(localizer());
    next.restore(state);
    EXPECT_EQ(next.states().at(0).record, nullptr);
    EXPECT_EQ(next.states().at(0).bursts, first.states().at(0).bursts);
    EXPECT_EQ(next.record(0)->received.size(), first.record(0)->received.size());
    next.restart();  // restored evidence holds again
    EXPECT_EQ(learns(next, cut), needed) << cut;
    ASSERT_EQ(next.states().at(0).knowledge, ChainKnowledge::kLearned);
    for (std::size_t m = 1; m < 3; ++m) {
      EXPECT_NEAR(phase_error(next.states().at(0), factors, m),
                  phase_error(whole.states().at(0), factors, m),
                  1e-3);
    }
  }
}

// Many bursts of an earlier run are evaluated a few at a time, and none is lost or decides before.
TEST(ChainLearner, EvaluatesTheBurstsOfAnEarlierRunAFewAtATime) {
  const std::vector<Value> factors = {1.0, std::polar(1.1, 0.6), std::polar(1.0, 3.0)};
  ChainLearner first(localizer());
  first.power_cycled(0, burst(0).front().time);
  for (int i = 0; i < 5; ++i) {
    first.receive(through(burst(i), factors));
  }
  ChainState state = first.states().at(0);
  ChainRecord record = *first.record(0);
  const std::vector<ChainRecord::Burst> once = record.received;
  ASSERT_GT(once.size(), 2U);
  while (record.received.size() <= 4 * kEvaluatedAtOnce) {
    record.received.insert(record.received.end(), once.begin(), once.end());
  }
  record.bursts = record.received.size();
  state.record = std::make_shared<const ChainRecord>(record);
  ChainLearner next(localizer());
  next.restore(state);
  for (int i = 5; i < 7; ++i) {
    next.receive(through(burst(i), factors));
    const auto now = next.record(0);
    ASSERT_TRUE(now) << "decided while bursts wait";
    EXPECT_EQ(now->received.size(), now->bursts);
    for (std::size_t k = 0; k < record.received.size(); ++k) {
      EXPECT_EQ(now->received[k].time, record.received[k].time) << k;
    }
    // A burst that waits is a remembered one.
    auto repeated = burst(1, 77);
    for (CsiFrame& frame : repeated) {
      frame.time += std::chrono::seconds(2 * i - 1);
    }
    next.receive(through(repeated, factors));
    EXPECT_EQ(next.states().at(0).bursts, now->bursts);
  }
}

TEST(ChainLearner, APowerCycleEndsTheEvidenceOfAnEarlierRun) {
  const std::vector<Value> factors = {1.0, std::polar(1.1, 0.6), std::polar(1.0, 3.0)};
  ChainLearner first(localizer());
  first.power_cycled(0, burst(0).front().time);
  for (int i = 0; i < 5; ++i) {
    first.receive(through(burst(i), factors));
  }
  ChainState state = first.states().at(0);
  state.record = std::make_shared<const ChainRecord>(*first.record(0));
  ChainLearner next(localizer());
  next.restore(state);
  next.power_cycled(0, burst(5).front().time);
  EXPECT_FALSE(next.record(0));
  EXPECT_EQ(next.states().at(0).bursts, 0U);
}

// The belief that a burst's own coarse fix uses does not contain the burst.
TEST(ChainLearner, StatesTheBeliefBeforeABurst) {
  ChainLearner learner(localizer());
  EXPECT_TRUE(learner.beliefs_before(burst(1)).at(0).empty());
  learner.power_cycled(0, burst(1).front().time);
  learner.receive(burst(1));
  ASSERT_EQ(learner.states().at(0).bursts, 1U);
  const std::vector<double> after_first = learner.record(0)->belief;
  EXPECT_FALSE(learner.beliefs_before(burst(1)).at(0).empty());
  EXPECT_NE(learner.beliefs_before(burst(1)).at(0), after_first);
  learner.receive(burst(2));
  EXPECT_EQ(learner.beliefs_before(burst(2)).at(0), after_first);
}

// The belief contains the evidence of such a burst: that of the one that it repeats.
TEST(ChainLearner, ARepeatedBurstHasNoBelief) {
  ChainLearner learner(localizer());
  learner.power_cycled(0, burst(1).front().time);
  learner.receive(burst(1));
  for (const auto later : {std::chrono::milliseconds(100), std::chrono::milliseconds(2000)}) {
    auto repeated = burst(1, 77);
    for (CsiFrame& frame : repeated) {
      frame.time += later;
    }
    learner.receive(repeated);
    EXPECT_EQ(learner.states().at(0).bursts, 1U);
    EXPECT_TRUE(learner.beliefs_before(repeated).at(0).empty()) << later.count();
  }
}

// A transmitter at a known place decides which of similar states is right; alone it counts as one
// burst, whatever it sends.
TEST(ChainLearner, LearnsEarlierWithATransmitterAtAKnownPlace) {
  const std::vector<Value> factors = {1.0, std::polar(1.1, 2.2), std::polar(0.9, -1.5)};
  const Vec3d place{0.7, -0.6, 1.9};
  auto fixed = through(test::frames_at(localizer()->room(), place, {4, 30.0, 77}), factors);
  for (CsiFrame& frame : fixed) {
    frame.time += std::chrono::seconds(10);
  }
  const auto bursts_until_learned = [&](bool with_fixed) {
    ChainLearner learner(localizer());
    learner.power_cycled(0, fixed.front().time);
    if (with_fixed) {
      for (int i = 0; i < 3; ++i) {
        learner.receive(fixed, place);
      }
      EXPECT_EQ(learner.states().at(0).bursts, 1U);
      EXPECT_EQ(learner.states().at(0).knowledge, ChainKnowledge::kLearning);
    }
    int bursts = 0;
    while (bursts < 40 && learner.states().at(0).knowledge != ChainKnowledge::kLearned) {
      learner.receive(through(burst(10 + bursts++), factors));
    }
    for (std::size_t m = 1; m < 3; ++m) {
      EXPECT_NEAR(phase_error(learner.states().at(0), factors, m), 0.0, 0.3);
    }
    return bursts;
  };
  EXPECT_LE(bursts_until_learned(true), bursts_until_learned(false));
}

// The evidence of places within the cells is far better than that of the cells, 5 cm wide.
TEST(ChainLearner, BecomesBetterWithBurstsThatComeAfterwards) {
  const std::vector<Value> factors = {1.0, std::polar(1.1, 1.1), std::polar(0.9, -2.0)};
  ChainLearner learner(localizer());
  for (int i = 0; i < 60; ++i) {
    learner.receive(through(burst(i), factors));
  }
  const ChainState state = learner.states().at(0);
  ASSERT_EQ(state.knowledge, ChainKnowledge::kLearned);
  for (std::size_t m = 1; m < 3; ++m) {
    EXPECT_NEAR(phase_error(state, factors, m), 0.0, 0.05);
  }
}

}  // namespace
}  // namespace rayloc::chain_learner_test
