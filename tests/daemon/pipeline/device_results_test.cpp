#include "daemon/pipeline/device/device_results.h"

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::device_results_test {
namespace {

const MacAddress kListed{{0x02, 0x52, 0x4c, 0, 0, 1}};
const MacAddress kOther{{0x02, 0x52, 0x4c, 0, 0, 2}};

Timestamp at(int seconds) { return Timestamp(std::chrono::seconds(seconds)); }

class DeviceResultsTest : public ::testing::Test {
 protected:
  DeviceResultsTest() {
    site_.name = "hall";
    SiteTransmitter& phone = site_.transmitters.emplace_back();
    phone.mac = kListed;
    phone.name = "phone";
    room_.scene_hash = "scene";
    room_.calibration_id = "calibration";
  }
  DeviceResults results(TargetNames::Options names = {}) const {
    return {site_, {"fake", std::chrono::seconds(2), std::make_shared<TargetNames>(names)}};
  }
  static DeviceUpdate update(const MacAddress& device, Timestamp time, TrackState state) {
    DeviceUpdate made;
    made.device = device;
    made.estimate.location.time = time;
    made.estimate.state = state;
    return made;
  }

  Site site_;
  RoomModel room_;
  Estimates out_;
};

TEST_F(DeviceResultsTest, ASnapshotHasTheNameAndTheContextButNoTrack) {
  LocationEstimate estimate;
  estimate.time = at(5);
  estimate.reason = "no path";
  results().append(estimate, kListed, room_, out_);
  ASSERT_EQ(out_.locations.size(), 1U);
  const Location& location = out_.locations.front();
  EXPECT_EQ(location.estimate.reason, "no path");
  EXPECT_EQ(location.target.name, "phone");
  EXPECT_EQ(location.target.address, "02:52:4c:00:00:01");
  EXPECT_FALSE(location.target.track);
  EXPECT_FALSE(location.is_filtered());
  EXPECT_EQ(location.context.site, "hall");
  EXPECT_EQ(location.context.scene_hash, "scene");
  EXPECT_EQ(location.context.calibration_id, "calibration");
  EXPECT_EQ(location.context.method, "fake");
  EXPECT_EQ(location.context.valid_for, Duration(std::chrono::seconds(2)));
}

TEST_F(DeviceResultsTest, AHashedAddressHasNoName) {
  results({.hashed = true}).append(LocationEstimate(), kListed, room_, out_);
  ASSERT_EQ(out_.locations.size(), 1U);
  EXPECT_TRUE(out_.locations.front().target.is_hashed);
  EXPECT_TRUE(out_.locations.front().target.name.empty());
}

TEST_F(DeviceResultsTest, EveryTrackHasANumberOfItsOwn) {
  DeviceResults results = this->results();
  results.append({update(kListed, at(1), TrackState::kTentative),
                  update(kOther, at(1), TrackState::kTentative),
                  update(kListed, at(2), TrackState::kLost),
                  update(kListed, at(3), TrackState::kTentative)},
                 room_,
                 out_);
  std::vector<std::uint64_t> tracks;
  for (const Location& location : out_.locations) {
    EXPECT_TRUE(location.is_filtered());
    tracks.push_back(location.target.track.value_or(0));
  }
  EXPECT_EQ(tracks, (std::vector<std::uint64_t>{1, 2, 1, 3}));
  EXPECT_TRUE(out_.events.empty());
  results.advance(at(4));
  EXPECT_EQ(results.carried().last, 3U);
  EXPECT_EQ(results.carried().tracks.size(), 2U) << "the lost track is over";
}

TEST_F(DeviceResultsTest, ATransitionIsAnEventOfTheSameTarget) {
  DeviceUpdate begun = update(kListed, at(1), TrackState::kTentative);
  begun.estimate.transition =
      TrackTransition{at(1), std::nullopt, TrackState::kTentative, "its first burst"};
  results().append({begun}, room_, out_);
  ASSERT_EQ(out_.events.size(), 1U);
  EXPECT_EQ(out_.events.front().target.track, out_.locations.front().target.track);
  EXPECT_EQ(out_.events.front().target.name, "phone");
}

TEST_F(DeviceResultsTest, ASuccessorContinuesTheNumbers) {
  DeviceResults first = results();
  first.append({update(kOther, at(1), TrackState::kTentative),
                update(kListed, at(1), TrackState::kTentative)},
               room_,
               out_);
  first.advance(at(2));
  DeviceResults second = results();
  second.go_on(first.carried(), at(2));
  out_.clear();
  second.append({update(kListed, at(3), TrackState::kConfirmed)}, room_, out_);
  EXPECT_EQ(out_.locations.front().target.track, 2U);
}

}  // namespace
}  // namespace rayloc::device_results_test
