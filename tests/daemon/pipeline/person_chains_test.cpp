// Tests the frames that people are located with after a power cycle of an access point.
#include "daemon/pipeline/person_chains.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "daemon/pipeline/device/chain_file.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/person_estimator.h"
#include "engine/room/preprocess_burst.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/person_in_room.h"

namespace rayloc::person_chains_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kPhase = 1.8;  // [rad], of the third chain of each access point when rotated

MacAddress plug(std::uint8_t number = 1) { return {{0x02, 0, 0, 0, 0, number}}; }

const std::shared_ptr<const RoomModel>& room() {
  static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
  return kRoom;
}

void rotate(std::vector<CsiFrame>& frames, double phase = kPhase) {
  for (std::size_t a = 0; a < 3; ++a) {
    test::turn_chain(frames, a, room()->access_points[a].rx_chains[2], phase);
  }
}

Burst burst_of(std::vector<CsiFrame> frames, const MacAddress& transmitter = plug()) {
  Burst burst;
  burst.transmitter = transmitter;
  burst.frames = std::move(frames);
  std::stable_sort(burst.frames.begin(), burst.frames.end(), [](const auto& a, const auto& b) {
    return a.time < b.time;
  });
  for (CsiFrame& frame : burst.frames) {
    frame.transmitter = transmitter;
  }
  burst.first = burst.received_since = burst.frames.front().time;
  burst.last = burst.frames.back().time;
  return burst;
}

// The empty room; rotated: after the power cycle.
Burst empty_room(bool rotated, unsigned seed = 1) {
  static const auto kChannels = test::channels_past(*room(), {});
  auto frames = test::frames_of(*room(), kChannels, {.count = 4, .seed = seed});
  if (rotated) {
    rotate(frames);
  }
  return burst_of(std::move(frames));
}

ChainState state_of(std::size_t access_point, ChainKnowledge knowledge) {
  ChainState state;
  state.access_point = access_point;
  state.knowledge = knowledge;
  state.factors = ChainFactors::unity(3);
  if (knowledge != ChainKnowledge::kAsCalibrated) {
    state.factors.factor[2] = std::polar(1.0, kPhase);
  }
  return state;
}
std::vector<ChainState> states_of(ChainKnowledge knowledge) {
  return {state_of(0, knowledge), state_of(1, knowledge), state_of(2, knowledge)};
}

// The reference of a transmitter by the arrays of a burst of the empty room.
PersonReference reference_of(const Burst& burst, const MacAddress& mac = plug()) {
  PersonReference reference;
  reference.mac = mac;
  reference.transmitter = test::fixed_transmitter();
  std::vector<std::string> warnings;
  for (std::size_t a = 0; a < 3; ++a) {
    reference.links.push_back(
        {a, preprocess_burst(*room(), a, burst.frames, {}, warnings)->h, 1.0, 0.9});
  }
  return reference;
}

// With a reference recorded before or after the power cycle.
struct Recorded {
  explicit Recorded(bool rotated) { chains.add(reference_of(empty_room(rotated, 99))); }
  PersonChains chains{"", room()};
};

// Largest difference between samples, as a share of the largest sample.
double difference(std::span<const CsiFrame> a, std::span<const CsiFrame> b) {
  double most = 0.0;
  double scale = 0.0;
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    for (std::size_t m = 0; m < a[i].rx_chains.size(); ++m) {
      for (std::size_t k = 0; k < a[i].csi.row(m, 0).size(); ++k) {
        most = std::max<double>(most, std::abs(a[i].csi.row(m, 0)[k] - b[i].csi.row(m, 0)[k]));
        scale = std::max<double>(scale, std::abs(b[i].csi.row(m, 0)[k]));
      }
    }
  }
  return most / scale;
}

TEST(PersonChains, WithoutLearnedChainsTheFramesAreThoseOfTheBurst) {
  Recorded recorded(false);
  const Burst burst = empty_room(false);
  const std::vector<ChainState> calibrated = states_of(ChainKnowledge::kAsCalibrated);
  for (const std::vector<ChainState>* states :
       {&calibrated, static_cast<decltype(&calibrated)>(nullptr)}) {
    const PersonChains::Usable usable = recorded.chains.usable(burst, states);
    EXPECT_EQ(usable.frames.data(), burst.frames.data());
    EXPECT_EQ(usable.frames.size(), burst.frames.size());
    EXPECT_THAT(usable.warnings, IsEmpty());
    EXPECT_EQ(usable.reason, "");
  }
}

TEST(PersonChains, LearnedFactorsAreRemoved) {
  Recorded recorded(false);
  const std::vector<ChainState> learned = states_of(ChainKnowledge::kLearned);
  const PersonChains::Usable usable = recorded.chains.usable(empty_room(true), &learned);
  EXPECT_LT(difference(usable.frames, empty_room(false).frames), 1e-5);
  EXPECT_THAT(usable.warnings, IsEmpty());
}

TEST(PersonChains, AReferenceRecordedAfterThePowerCycleIsComparedAsReceived) {
  Recorded recorded(true);
  const std::vector<ChainState> learned = states_of(ChainKnowledge::kLearned);
  const PersonChains::Usable usable = recorded.chains.usable(empty_room(true), &learned);
  EXPECT_LT(difference(usable.frames, empty_room(true).frames), 1e-5);
  ASSERT_THAT(usable.warnings, SizeIs(3)) << "for each access point";
  EXPECT_THAT(usable.warnings[0], HasSubstr("rayloc reference"));
}

TEST(PersonChains, AfterAnotherPowerCycleTheFramesHaveTheChainsOfTheReference) {
  Recorded recorded(true);
  std::vector<ChainState> learned = states_of(ChainKnowledge::kLearned);
  for (ChainState& state : learned) {
    state.is_confirmed = true;
  }
  recorded.chains.usable(empty_room(true), &learned);
  const std::vector<ChainState> learning = states_of(ChainKnowledge::kLearning);
  Burst burst = empty_room(true);
  rotate(burst.frames, 2.0);
  recorded.chains.usable(burst, &learning);
  for (ChainState& state : learned) {
    state.factors.factor[2] = std::polar(1.0, kPhase + 2.0);
  }
  const PersonChains::Usable usable = recorded.chains.usable(burst, &learned);
  EXPECT_LT(difference(usable.frames, empty_room(true).frames), 1e-5);
}

TEST(PersonChains, AccessPointsThatAreBeingLearnedAreLeftOut) {
  Recorded recorded(false);
  const std::vector<ChainState> one{state_of(1, ChainKnowledge::kLearning)};
  const Burst burst = empty_room(false);
  const PersonChains::Usable some = recorded.chains.usable(burst, &one);
  EXPECT_EQ(some.frames.size(), 8U) << "of two access points";
  EXPECT_EQ(some.reason, "");
  EXPECT_THAT(some.warnings, ElementsAre(HasSubstr("learning the chains of b")));
  const std::vector<ChainState> all = states_of(ChainKnowledge::kLearning);
  const PersonChains::Usable none = recorded.chains.usable(burst, &all);
  EXPECT_THAT(none.frames, IsEmpty());
  EXPECT_THAT(none.reason, HasSubstr("learning the chains of a: 0 of at least 10 bursts; "));
}

TEST(PersonChains, ChainsThatTheCalibrationDoesNotStateAreUsedAsReceived) {
  RoomModel unsurveyed = *room();
  unsurveyed.access_points[0].are_chains_known = false;
  PersonChains chains("", std::make_shared<const RoomModel>(unsurveyed));
  chains.add(reference_of(empty_room(true, 99)));
  for (const ChainKnowledge knowledge : {ChainKnowledge::kLearning, ChainKnowledge::kLearned}) {
    const std::vector<ChainState> states{state_of(0, knowledge)};
    const PersonChains::Usable usable = chains.usable(empty_room(true), &states);
    EXPECT_EQ(difference(usable.frames, empty_room(true).frames), 0.0);
    EXPECT_THAT(usable.warnings, IsEmpty());
  }
}

TEST(PersonChains, AFileStatesTheChainsOfBurstsWithoutAState) {
  const auto file = std::filesystem::path(::testing::TempDir()) /
                    ("person_chains_" + std::to_string(::getpid()) + ".json");
  ASSERT_TRUE(write_chain_file(file, states_of(ChainKnowledge::kLearned), *room()));
  PersonChains chains(file, room());
  std::filesystem::remove(file);
  chains.add(reference_of(empty_room(false, 99)));
  EXPECT_THAT(chains.notices(), SizeIs(3));
  const PersonChains::Usable usable = chains.usable(empty_room(true), nullptr);
  EXPECT_LT(difference(usable.frames, empty_room(false).frames), 1e-5);
  const std::vector<ChainState> calibrated = states_of(ChainKnowledge::kAsCalibrated);
  const Burst burst = empty_room(false);
  const PersonChains::Usable newer = chains.usable(burst, &calibrated);
  EXPECT_EQ(newer.frames.data(), burst.frames.data()) << "the burst's state holds";
}

TEST(PersonChains, AFileOfChainsThatWereNotLearnedIsTheReason) {
  const auto file = std::filesystem::path(::testing::TempDir()) /
                    ("unlearned_chains_" + std::to_string(::getpid()) + ".json");
  ASSERT_TRUE(write_chain_file(file, states_of(ChainKnowledge::kLearning), *room()));
  PersonChains chains(file, room());
  std::filesystem::remove(file);
  chains.add(reference_of(empty_room(false, 99)));
  const std::string text =
      "access point a: its chains were not learned when " + file.string() + " was written";
  const std::vector<std::string> notices = chains.notices();
  ASSERT_THAT(notices, SizeIs(3));
  EXPECT_EQ(notices[0], text);
  const PersonChains::Usable usable = chains.usable(empty_room(true), nullptr);
  EXPECT_THAT(usable.frames, IsEmpty());
  EXPECT_THAT(usable.reason, HasSubstr(text + "; "));
  ASSERT_THAT(usable.warnings, SizeIs(3));
  EXPECT_EQ(usable.warnings[0], "chain_phase_jump: " + text + "; its CSI is not used");
}

// Reports the frames it gets.
class FakePeople : public PersonMethod {
 public:
  std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                       std::uint64_t) const override {
    LocationEstimate estimate;
    estimate.reason = std::to_string(frames.size()) + " frames";
    for (const CsiFrame& frame : frames) {
      estimate.reason +=
          " " + std::to_string(std::arg(frame.csi.row(2, 0)[0] / frame.csi.row(0, 0)[0]));
    }
    return {estimate};
  }
};

Expected<std::unique_ptr<PersonMethod>> make_fake_people(PersonMethodInput) {
  return std::make_unique<FakePeople>();
}
constexpr Method kFakePeople = {
    .name = "fake", .summary = "", .domain = "", .create_person = &make_fake_people};

// Replaces DeviceEstimator: it learns the chains from the second burst on.
class FakeLearner : public Estimator {
 public:
  void estimate(const Burst&, Estimates& out) override {
    const ChainKnowledge knowledge = bursts_ == 0   ? ChainKnowledge::kAsCalibrated
                                     : bursts_ == 1 ? ChainKnowledge::kLearning
                                                    : ChainKnowledge::kLearned;
    out.chains = std::make_shared<const std::vector<ChainState>>(states_of(knowledge));
    ++bursts_;
  }

 private:
  int bursts_ = 0;
};

Site site_of(std::uint8_t plugs) {
  Site site;
  for (std::uint8_t i = 1; i <= plugs; ++i) {
    SiteTransmitter& fixed = site.transmitters.emplace_back();
    fixed.role = TransmitterRole::kFixed;
    fixed.mac = plug(i);
    fixed.position = test::fixed_transmitter().position;
  }
  return site;
}

std::vector<std::string> reasons(const std::vector<Estimates>& all) {
  std::vector<std::string> texts;
  for (const Estimates& one : all) {
    for (const Location& location : one.locations) {
      texts.push_back(location.target.name + location.estimate.reason);
    }
  }
  return texts;
}

TEST(PersonChains, ResultsDoNotDependOnTheSizeOfABatch) {
  constexpr std::uint8_t kPlugs = 4;
  std::vector<Burst> bursts;
  std::vector<PersonReference> references;
  for (std::uint8_t i = 1; i <= kPlugs; ++i) {
    bursts.push_back(burst_of(empty_room(i > 1).frames, plug(i)));
    references.push_back(reference_of(empty_room(false, 99), plug(i)));
  }
  PersonEstimator::Options options;
  options.method = &kFakePeople;
  std::vector<std::vector<std::string>> results;
  for (const std::size_t size : {1U, 2U, 4U}) {
    FakeLearner learner;
    const auto people =
        PersonEstimator::create(site_of(kPlugs), options, room(), references).value();
    EstimatorList list;
    list.add(learner);
    list.add(*people);
    std::vector<Estimates> out(bursts.size());
    for (std::size_t i = 0; i < bursts.size(); i += size) {
      list.estimate_each(std::span(bursts).subspan(i, size), std::span(out).subspan(i, size));
    }
    results.push_back(reasons(out));
  }
  ASSERT_THAT(results[0], SizeIs(kPlugs));
  EXPECT_THAT(results[0][0], HasSubstr("12 frames"));
  EXPECT_THAT(results[0][1], HasSubstr("learning the chains of a"));
  EXPECT_THAT(results[0][2], HasSubstr("12 frames"));
  EXPECT_EQ(results[1], results[0]);
  EXPECT_EQ(results[2], results[0]);
}

TEST(PersonChains, APersonIsLocatedAsWithoutThePowerCycle) {
  PersonReference reference = test::learn_reference(*room());
  reference.mac = plug();
  PersonEstimator::Options options;
  options.settings.values["person_cell_m"] = 0.1;  // fine enough to detect a person, and fast
  const auto people = PersonEstimator::create(site_of(1), options, room(), {reference}).value();
  const Burst before = burst_of(
      test::frames_past(*room(), {{0.1, 0.2}}, PersonModel{}.body, {.count = 8, .seed = 3}));
  Burst after = before;
  rotate(after.frames);
  Estimates calibrated;
  people->estimate(before, calibrated);
  people->restart("again", calibrated);
  Estimates learned;
  learned.chains =
      std::make_shared<const std::vector<ChainState>>(states_of(ChainKnowledge::kLearned));
  people->estimate(after, learned);
  const LocationEstimate& one = calibrated.locations.at(0).estimate;
  const LocationEstimate& other = learned.locations.at(0).estimate;
  ASSERT_TRUE(one.position) << one.reason;
  ASSERT_TRUE(other.position) << other.reason;
  EXPECT_NEAR(one.position->x, other.position->x, 1e-3);
  EXPECT_NEAR(one.position->y, other.position->y, 1e-3);
  EXPECT_NEAR(one.accuracy_m, other.accuracy_m, 1e-3);
  EXPECT_EQ(one.warnings, other.warnings);
}

}  // namespace
}  // namespace rayloc::person_chains_test
