#include "daemon/pipeline/device/chain_supervisor.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <complex>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "daemon/pipeline/warm/carried.h"
#include "daemon/site/model/reference_file.h"
#include "engine/room/preprocess_burst.h"
#include "tests/daemon/pipeline/fake_devices.h"
#include "tests/support/faulty_frames.h"

namespace rayloc::chain_supervisor_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const Timestamp kFirst(std::chrono::seconds(100));

class ChainSupervisorTest : public ::testing::Test {
 protected:
  ChainSupervisorTest() { EXPECT_TRUE(chains_.prepare(fake_.site, test::make_room())); }

  test::FakeChains& fake(std::size_t room = 0) { return fake_.method(room).fake_chains; }

  test::FakeRooms fake_;
  ChainSupervisor chains_{{}, fake_.rooms};
  const Burst burst_ = test::burst_of(10, kFirst);
  std::vector<CsiFrame> kept_;
};

TEST_F(ChainSupervisorTest, FramesOfCalibratedChainsAreThoseOfTheBurst) {
  const auto frames = chains_.accept(burst_, fake_.rooms.of(nullptr), kept_);
  EXPECT_EQ(frames.data(), burst_.frames.data());
  EXPECT_EQ(frames.size(), 10U);
  EXPECT_EQ(fake().received, 1);
  EXPECT_TRUE(chains_.chain_warnings().empty());
  EXPECT_EQ(chains_.trust(fake_.rooms.of(nullptr), frames).withdrawals, 3U);
}

TEST_F(ChainSupervisorTest, FramesOfLearnedChainsAreAcceptedOnes) {
  fake().is_learning = true;
  fake().accepts = 4;
  const auto frames = chains_.accept(burst_, fake_.rooms.of(nullptr), kept_);
  EXPECT_EQ(frames.data(), kept_.data());
  EXPECT_EQ(frames.size(), 4U);
  ASSERT_THAT(chains_.chain_warnings(), SizeIs(1));
  EXPECT_THAT(chains_.chain_warnings()[0].text, HasSubstr("learning the chains"));
  EXPECT_THAT(chains_.reason(fake_.rooms.first()), HasSubstr("learning the chains"));
  EXPECT_THAT(fake(1).adopted, SizeIs(1)) << "the other room has the same access points";
  EXPECT_TRUE(fake(0).adopted.empty());
  EXPECT_THAT(chains_.notices(), SizeIs(1));
}

TEST_F(ChainSupervisorTest, AMethodThatLearnsNoChainsUsesEveryFrame) {
  fake_.method(0).has_chains = fake_.method(1).has_chains = false;
  EXPECT_EQ(chains_.accept(burst_, fake_.rooms.of(nullptr), kept_).size(), 10U);
  EXPECT_EQ(chains_.trust(fake_.rooms.of(nullptr), burst_.frames).withdrawals, 0U);
}

TEST_F(ChainSupervisorTest, ACoarseSnapshotWithoutPositionStatesThatChainsAreBeingLearned) {
  fake().is_learning = true;
  chains_.accept(burst_, fake_.rooms.of(nullptr), kept_);
  const LocationEstimate none = chains_.locate_coarsely(burst_, fake_.rooms.of(nullptr));
  EXPECT_THAT(none.reason, HasSubstr("learning the chains"));
  fake().coarse.reason = "the likelihood is flat";
  EXPECT_THAT(chains_.locate_coarsely(burst_, fake_.rooms.of(nullptr)).reason,
              AllOf(HasSubstr("learning the chains"), HasSubstr("the likelihood is flat")));
  fake().coarse.position = Vec3d{1.0, 0.0, 0.0};
  const LocationEstimate coarse = chains_.locate_coarsely(burst_, fake_.rooms.of(nullptr));
  ASSERT_THAT(coarse.warnings, SizeIs(1));
  EXPECT_THAT(coarse.warnings[0], HasSubstr("without the phases of the antennas: learning"));
}

TEST_F(ChainSupervisorTest, AFixedTransmitterTeachesTheFirstRoomAtItsPlace) {
  SiteTransmitter fixed;
  fixed.role = TransmitterRole::kFixed;
  fixed.position = Vec3d{0.4, 0.2, 1.0};
  chains_.check(fixed, burst_);
  ASSERT_THAT(fake().places, SizeIs(1));
  EXPECT_EQ(fake().places[0].x, 0.4);
  EXPECT_TRUE(fake(1).places.empty());
  EXPECT_TRUE(chains_.monitor_warnings().empty());
  Carried carried;
  chains_.carry(carried);
  ASSERT_THAT(carried.watched, SizeIs(1));
  EXPECT_EQ(carried.watched[0].last, burst_.last);
}

TEST_F(ChainSupervisorTest, ASuccessorRestoresTheStatesOfItsOwnAccessPoints) {
  Carried before;
  ChainState& state = before.chains.emplace_back();
  state.knowledge = ChainKnowledge::kLearned;
  state.factors = ChainFactors::unity(fake_.rooms.first().access_points[0].rx_chains.size());
  before.chains.push_back(state);
  before.chains.back().access_point = 99;
  chains_.go_on(before);
  EXPECT_THAT(fake(0).restored, SizeIs(1));
  EXPECT_THAT(fake(1).restored, SizeIs(1));
  EXPECT_THAT(chains_.states(), SizeIs(1));
}

TEST_F(ChainSupervisorTest, ARestartRestartsTheChainsOfEveryRoom) {
  fake().is_learning = true;
  chains_.accept(burst_, fake_.rooms.of(nullptr), kept_);
  chains_.restart();
  EXPECT_EQ(fake(0).restarts, 1);
  EXPECT_EQ(fake(1).restarts, 1);
  EXPECT_TRUE(chains_.chain_warnings().empty());
  EXPECT_TRUE(chains_.states().empty());
}

constexpr double kPhase = 1.8;  // [rad], of a chain after a power cycle, as learned
constexpr int kBursts = 25;     // more than the monitor needs

// A fixed transmitter whose reference was recorded with some phase of a chain of the first access
// point.
class ReferenceOfChains {
 public:
  // The chain is as learned by an earlier run.
  explicit ReferenceOfChains(double recorded) {
    RoomModel room = test::make_room();
    room.calibration_id = "calibration";
    SiteTransmitter& plug = fake_.site.transmitters.emplace_back();
    plug.role = TransmitterRole::kFixed;
    plug.mac = {{0x02, 0, 0, 0, 0, 7}};
    plug.position = Vec3d{1.1, -0.8, 1.2};
    PersonReference reference;
    reference.id = "reference";
    reference.mac = plug.mac;
    reference.transmitter.position = *plug.position;
    std::vector<std::string> warnings;
    reference.links.push_back(
        {0, preprocess_burst(room, 0, burst(recorded, 99).frames, {}, warnings)->h, 1.0, 0.9});
    const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) /
                                       ("chain_reference_" + std::to_string(::getpid()) + ".toml");
    std::ofstream(file) << reference_toml({reference}, room, 0);
    fake_.site.reference_file = file;
    const auto prepared = chains_.prepare(fake_.site, room);
    EXPECT_TRUE(prepared) << (prepared ? "" : prepared.error().message);
    std::filesystem::remove(file);
    set_learned(kPhase);
  }

  // The chain is learned since the start.
  void learn(double phase) {
    chains().learned.reset();
    chains().is_learning = true;
    receive_device();
    chains().is_learning = false;
    set_learned(phase);
  }
  // Receives a burst of a device after which the learned chains are wrong with this probability.
  void receive_device(double wrong) {
    chains().fault.probability = wrong;
    chains().counts = true;
    receive_device();
  }

  // Receives bursts with that phase of the chain.
  void receive(double phase) {
    for (int i = 0; i < kBursts; ++i) {
      chains_.check(fake_.site.transmitters.back(), burst(phase, static_cast<unsigned>(i + 1)));
    }
  }
  test::FakeChains& chains() { return fake_.method().fake_chains; }
  bool has_jump() const {
    const auto warnings = chains_.monitor_warnings();
    return std::any_of(warnings.begin(), warnings.end(), [](const CalibrationWarning& warning) {
      return warning.problem == CalibrationProblem::kChainPhaseJump;
    });
  }
  // New lines of the log that name the reference.
  std::size_t reference_notices() {
    std::size_t count = 0;
    for (const std::string& line : chains_.notices()) {
      count += line.find("rayloc reference") != std::string::npos ? 1U : 0U;
    }
    return count;
  }

 private:
  void receive_device() {
    std::vector<CsiFrame> kept;
    chains_.accept(burst(0.0, 1), fake_.rooms.of(nullptr), kept);
  }
  void set_learned(double phase) {
    ChainState& state = chains().learned.emplace();
    state.knowledge = ChainKnowledge::kLearned;
    state.factors = ChainFactors::unity(3);
    state.factors.factor[2] = std::polar(1.0, phase);
  }
  static Burst burst(double phase, unsigned seed) {
    static const RoomModel kRoom = test::make_room();
    static const std::vector<std::complex<double>> kChannel =
        test::channel_at(kRoom, kRoom.access_points[0], {1.1, -0.8, 1.2});
    Burst burst;
    burst.transmitter = {{0x02, 0, 0, 0, 0, 7}};
    burst.frames = test::frames_of(kRoom, {kChannel, {}, {}}, {.count = 4, .seed = seed});
    test::turn_chain(burst.frames, 0, kRoom.access_points[0].rx_chains[2], phase);
    burst.first = burst.received_since = kFirst + static_cast<int>(seed) * std::chrono::seconds(1);
    for (CsiFrame& frame : burst.frames) {
      frame.transmitter = burst.transmitter;
      frame.time = burst.first + frame.time.time_since_epoch();
    }
    burst.last = burst.frames.back().time;
    return burst;
  }

  test::FakeRooms fake_;
  ChainSupervisor chains_{{}, fake_.rooms};
};

TEST(ChainReferences, LearnedChainsFitTheReferenceOfTheCalibration) {
  ReferenceOfChains plug(0.0);
  plug.receive(kPhase);
  EXPECT_EQ(plug.chains().power_cycles, 0);
  EXPECT_EQ(plug.reference_notices(), 0U);
  plug.receive(0.0);
  EXPECT_EQ(plug.chains().power_cycles, 1) << "other chains than the learned ones";
}

TEST(ChainReferences, AReferenceRecordedAfterThePowerCycleKeepsLearnedChains) {
  ReferenceOfChains plug(kPhase);
  plug.learn(kPhase);
  plug.receive(kPhase);
  EXPECT_EQ(plug.chains().power_cycles, 0);
  EXPECT_FALSE(plug.has_jump());
  EXPECT_EQ(plug.reference_notices(), 1U) << "once";
  plug.receive(kPhase + 2.0);
  EXPECT_EQ(plug.chains().power_cycles, 1) << "a later power cycle is detected";
  EXPECT_TRUE(plug.has_jump());
  plug.learn(kPhase + 2.0);
  plug.receive(kPhase + 2.0);
  EXPECT_FALSE(plug.has_jump()) << "its chains are learned";
  EXPECT_EQ(plug.chains().power_cycles, 1);
  EXPECT_EQ(plug.reference_notices(), 0U);
}

TEST(ChainReferences, RestoredChainsThatADeviceContradictsAreDiscarded) {
  ReferenceOfChains plug(0.0);
  plug.receive(0.0);  // the chains are as calibrated again
  EXPECT_TRUE(plug.has_jump());
  EXPECT_EQ(plug.chains().power_cycles, 0) << "or the reference contains the learned factors";
  EXPECT_EQ(plug.reference_notices(), 1U);
  plug.receive_device(0.2);
  EXPECT_EQ(plug.chains().power_cycles, 0);
  plug.receive_device(0.8);
  EXPECT_EQ(plug.chains().power_cycles, 1);
}

TEST(ChainReferences, RestoredChainsThatADeviceConfirmsAreThoseOfTheReference) {
  ReferenceOfChains plug(kPhase);
  plug.receive(kPhase);
  EXPECT_EQ(plug.reference_notices(), 1U);
  plug.receive_device(0.001);
  plug.receive(kPhase);
  EXPECT_EQ(plug.chains().power_cycles, 0);
  EXPECT_FALSE(plug.has_jump());
  EXPECT_EQ(plug.reference_notices(), 1U) << "the reference contains the factors";
}

TEST(ChainReferences, RestoredChainsThatFitNeitherWayAreDiscarded) {
  ReferenceOfChains plug(0.0);
  plug.receive(kPhase + 2.0);  // another power cycle while no program ran
  EXPECT_TRUE(plug.has_jump());
  EXPECT_EQ(plug.chains().power_cycles, 1);
  EXPECT_EQ(plug.reference_notices(), 0U);
}

TEST_F(ChainSupervisorTest, SharesItsStatesWithTheEstimatorsThatFollow) {
  fake().is_learning = true;
  chains_.accept(burst_, fake_.rooms.of(nullptr), kept_);
  ASSERT_TRUE(chains_.shared_states());
  ASSERT_THAT(*chains_.shared_states(), SizeIs(1));
  EXPECT_EQ(chains_.shared_states()->front().knowledge, ChainKnowledge::kLearning);
  EXPECT_FALSE(chains_.shared_states()->front().is_confirmed);
  fake().is_learning = false;
  ChainState& learned = fake().learned.emplace();
  learned.knowledge = ChainKnowledge::kLearned;
  learned.factors = ChainFactors::unity(3);
  fake().counted = 5;  // a change
  chains_.accept(burst_, fake_.rooms.of(nullptr), kept_);
  EXPECT_TRUE(chains_.shared_states()->front().is_confirmed) << "learned since the start";
  fake_.method(0).has_chains = fake_.method(1).has_chains = false;
  EXPECT_FALSE(chains_.shared_states()) << "no method learns chains";
}

}  // namespace
}  // namespace rayloc::chain_supervisor_test
