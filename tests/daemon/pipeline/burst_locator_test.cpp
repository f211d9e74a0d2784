#include "daemon/pipeline/device/burst_locator.h"

#include <chrono>
#include <memory>
#include <vector>

#include <gmock/gmock.h>

#include "tests/daemon/pipeline/fake_devices.h"

namespace rayloc::burst_locator_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Timestamp kFirst(std::chrono::seconds(100));

class BurstLocatorTest : public ::testing::Test {
 protected:
  BurstWork work() {
    BurstWork work;
    work.burst = &burst_;
    work.out = &out_;
    work.room = &fake_.rooms.of(nullptr);
    work.frames = burst_.frames;
    return work;
  }
  // The burst from its reception to its estimates.
  void locate(BurstWork work, Snapshots snapshots = Snapshots::kAlways) {
    BurstLocator locator(snapshots, chains_, results_);
    locator.begin(work);
    locator.track({&work, 1}, fake_.rooms.all());
  }
  std::vector<bool> are_filtered() const {
    std::vector<bool> all;
    for (const Location& location : out_.locations) {
      all.push_back(location.is_filtered());
    }
    return all;
  }

  test::FakeRooms fake_;
  ChainSupervisor chains_{{}, fake_.rooms};
  DeviceResults results_{fake_.site, {"fake", {}, std::make_shared<TargetNames>()}};
  Burst burst_ = test::burst_of(10, kFirst);
  Estimates out_;
};

TEST_F(BurstLocatorTest, ABurstGivesASnapshotAndThenTheEstimatesOfItsTrack) {
  locate(work());
  EXPECT_THAT(are_filtered(), ElementsAre(false, true));
  EXPECT_EQ(out_.locations[0].estimate.reason, "10 frames");
  EXPECT_THAT(fake_.method().fake_tracks.frames, ElementsAre(10U));
}

TEST_F(BurstLocatorTest, AConfirmedTrackNeedsNoSnapshot) {
  locate(work(), Snapshots::kAcquire);
  EXPECT_THAT(are_filtered(), ElementsAre(false, true)) << "not confirmed";
  fake_.method().fake_tracks.is_followed = true;
  out_.clear();
  locate(work(), Snapshots::kAcquire);
  EXPECT_THAT(are_filtered(), ElementsAre(true));
}

TEST_F(BurstLocatorTest, ABurstThatIsBehindContributesItsLastMoment) {
  burst_.received_since = kFirst - std::chrono::seconds(1);
  locate(work());
  EXPECT_THAT(are_filtered(), ElementsAre(true));
  ASSERT_EQ(fake_.method().fake_tracks.frames.size(), 1U);
  EXPECT_LT(fake_.method().fake_tracks.frames.front(), 10U);
  EXPECT_EQ(out_.frames_left_out, 10U - fake_.method().fake_tracks.frames.front());
}

TEST_F(BurstLocatorTest, ABurstThatIsBehindGivesASnapshotWhereNoTrackReports) {
  burst_.received_since = kFirst - std::chrono::seconds(1);
  fake_.method().fake_tracks.reports = false;
  locate(work());
  EXPECT_THAT(are_filtered(), ElementsAre(false));
}

TEST_F(BurstLocatorTest, AMethodWithoutTracksGivesASnapshotOfTheWholeBurst) {
  fake_.method().has_tracks = false;
  burst_.received_since = kFirst - std::chrono::seconds(1);
  locate(work(), Snapshots::kAcquire);
  EXPECT_THAT(are_filtered(), ElementsAre(false));
  EXPECT_EQ(out_.locations[0].estimate.reason, "10 frames");
  EXPECT_EQ(out_.frames_left_out, 0U);
}

TEST_F(BurstLocatorTest, ABurstWithoutUsableFramesIsLocatedCoarsely) {
  BurstWork empty = work();
  empty.frames = {};
  fake_.method().fake_chains.coarse.position = Vec3d{1.0, 0.0, 0.0};
  locate(empty);
  EXPECT_THAT(are_filtered(), ElementsAre(false)) << "no track is given the burst";
  EXPECT_THAT(out_.locations[0].estimate.warnings,
              ElementsAre(HasSubstr("coarse, without the phases")));
  EXPECT_TRUE(fake_.method().fake_tracks.frames.empty());
}

TEST_F(BurstLocatorTest, ABurstWithWrongStampsGivesNoPositionAndTheReason) {
  const RoomModel room = test::make_room();
  BurstLocator(Snapshots::kAlways, chains_, results_).refuse(burst_, {0, kFirst, 20}, room, out_);
  ASSERT_EQ(out_.locations.size(), 1U);
  EXPECT_FALSE(out_.locations[0].estimate.position);
  EXPECT_THAT(out_.locations[0].estimate.reason, HasSubstr("time stamps do not advance"));
}

}  // namespace
}  // namespace rayloc::burst_locator_test
