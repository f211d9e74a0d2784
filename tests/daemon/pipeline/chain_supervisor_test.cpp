#include "daemon/pipeline/device/chain_supervisor.h"

#include <chrono>
#include <vector>

#include <gmock/gmock.h>

#include "daemon/pipeline/warm/carried.h"
#include "tests/daemon/pipeline/fake_devices.h"

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

}  // namespace
}  // namespace rayloc::chain_supervisor_test
