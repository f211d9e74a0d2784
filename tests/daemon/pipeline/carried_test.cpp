// Tests the state that a pipeline passes to the next: numbers, stays, verdicts, and its message.
#include "daemon/pipeline/warm/carried.h"

#include <gtest/gtest.h>

#include "daemon/messages/json.h"
#include "daemon/pipeline/output/carried_message.h"

namespace rayloc::carried_test {
namespace {

constexpr Timestamp kStart{std::chrono::seconds(1'718'000'000)};

Timestamp at(double seconds) { return kStart + from_seconds(seconds); }

MacAddress mac(std::uint8_t last) { return {{2, 0x52, 0x4c, 0, 0, last}}; }

TEST(TrackNumbers, GivesEveryTrackANumberOfItsOwn) {
  TrackNumbers numbers;
  EXPECT_EQ(numbers.of(mac(1), "one", at(0)), 1U);
  EXPECT_EQ(numbers.of(mac(2), "two", at(0)), 2U);
  EXPECT_EQ(numbers.of(mac(1), "one", at(1)), 1U);
  numbers.lost(mac(1), at(2));
  EXPECT_EQ(numbers.of(mac(1), "one", at(3)), 3U);
  EXPECT_EQ(numbers.of(mac(2), "renamed", at(3)), 4U);
}

TEST(TrackNumbers, ASuccessorGoesOn) {
  TrackNumbers first;
  first.of(mac(1), "one", at(0));
  first.of(mac(2), "two", at(0));
  first.lost(mac(2), at(1));
  // After the last carried instant one track is lost and begins again, and another one begins.
  first.of(mac(3), "three", at(2));
  first.lost(mac(1), at(5.1));
  first.of(mac(1), "one", at(5.2));
  first.of(mac(4), "four", at(5.3));
  first.advance(at(5));
  TrackNumbers second(first.carried(), at(5));
  // Before its first own instant the successor assigns no number.
  EXPECT_EQ(second.of(mac(1), "one", at(3)), 1U);
  EXPECT_EQ(second.of(mac(9), "nine", at(3)), 0U);
  second.lost(mac(1), at(3));
  EXPECT_EQ(second.of(mac(1), "one", at(5.1)), 1U);
  second.lost(mac(1), at(5.1));
  EXPECT_EQ(second.of(mac(4), "four", at(5.3)), 5U);
  EXPECT_EQ(second.of(mac(1), "one", at(5.2)), 4U);
  EXPECT_EQ(second.of(mac(3), "three", at(5.4)), 3U);
  EXPECT_EQ(second.of(mac(2), "two", at(5.4)), 6U);
  EXPECT_EQ(second.of(mac(1), "one", at(5.5)), 4U);
}

TEST(TrackNumbers, ForgetsEndedTracksOnceTheirEndIsPublished) {
  TrackNumbers numbers;
  for (std::uint8_t i = 0; i < 200; ++i) {
    numbers.of(mac(i), std::to_string(i), at(i));
    numbers.lost(mac(i), at(i + 0.5));
    numbers.advance(at(i));
    EXPECT_LE(numbers.carried().tracks.size(), 1U);
  }
  TrackNumbers successor({7, {{"gone", 7}}}, at(0));
  successor.advance(at(11));
  EXPECT_TRUE(successor.carried().tracks.empty());
}

Carried filled() {
  Carried carried;
  carried.done = at(10.0001);
  carried.open = {at(10.2), {{mac(1), at(10.1), at(10.19)}, {mac(2), at(10.05), at(10.05)}}};
  carried.received = at(8);
  carried.devices = {7, {{"02:52:4c:00:00:01", 3}, {"02:52:4c:00:00:01", 7}}};
  carried.people = {{mac(9), 11, at(9.93)}};
  Target device;
  device.address = "02:52:4c:00:00:01";
  device.track = 3;
  device.name = "cart";
  Target person;
  person.kind = TargetKind::kPerson;
  person.track = 11;
  carried.zones.zones = {"desk", "door"};
  carried.zones.occupants = {
      {device, at(9.9), {{true, true, at(9.8), at(2), 0.25}, {true, false, {}, at(9), 0.75}}},
      {person, at(9.8), {{true, false, {}, at(1), 1.0}, {}}}};
  carried.zones.inside = {{1, 0}, {0}};
  ChainState chains;
  chains.access_point = 1;
  chains.knowledge = ChainKnowledge::kLearned;
  chains.factors.factor = {{1.0, 0.0}, {0.1, -0.9}};
  chains.factors.sigma = {0.0, 0.1};
  chains.factors.log_gain_sigma = {0.01, 0.02};
  chains.since = at(3);
  chains.bursts = 12;
  carried.chains = {chains};
  CalibrationMonitor::MonitorState monitor_state(2, 3, std::nullopt);
  monitor_state.bursts = 4;
  monitor_state.first = {0.91};
  monitor_state.fit = 0.9;
  monitor_state.slow = 0.1;
  monitor_state.moved = Debounce(CalibrationMonitor::kSteady, true, 1);
  monitor_state.jump[2] = Debounce(CalibrationMonitor::kSteady, false, 1);
  monitor_state.jump_phase[2] = 1.5;
  monitor_state.motion = {{0.01, -0.02, 0.0}, 0.03};
  monitor_state.moved_fit = 0.95;
  monitor_state.since_scan = 3;
  monitor_state.drifted = true;
  carried.calibration = {monitor_state};
  carried.watched = {{mac(2), at(9.95)}};
  return carried;
}

TEST(CarriedMessage, ComesBackTheSameAsBytesAndAsJson) {
  const v1::Carried message = carried_message(filled());
  const auto back = carried_of(message);
  ASSERT_TRUE(back);
  EXPECT_EQ(carried_message(*back).SerializeAsString(), message.SerializeAsString());
  EXPECT_EQ(back->done, at(10.0001));
  EXPECT_EQ(back->open.starts[1].first, at(10.05));
  EXPECT_EQ(back->devices.tracks[1].number, 7U);
  EXPECT_EQ(back->people[0].moment, at(9.93));
  EXPECT_EQ(back->zones.inside, filled().zones.inside);
  EXPECT_EQ(back->zones.occupants[0].stays[0].crossing, at(9.8));
  EXPECT_EQ(back->chains[0].factors.factor, filled().chains[0].factors.factor);
  EXPECT_EQ(back->calibration[0].jump[2].run(), 1);
  EXPECT_EQ(back->calibration[0].usual, std::nullopt);
  EXPECT_EQ(back->watched[0].last, at(9.95));
  v1::Carried read;
  ASSERT_TRUE(from_json(to_json(message).value(), read));
  EXPECT_EQ(read.SerializeAsString(), message.SerializeAsString());
}

TEST(CarriedMessage, RefusesContradictoryState) {
  v1::Carried zones = carried_message(filled());
  zones.mutable_occupants(1)->mutable_stays(0)->set_zone("attic");
  EXPECT_FALSE(carried_of(zones));
  v1::Carried chains = carried_message(filled());
  chains.mutable_chains(0)->add_factors(1.0);
  EXPECT_FALSE(carried_of(chains));
  v1::Carried verdicts = carried_message(filled());
  verdicts.mutable_calibration(0)->add_jump();
  EXPECT_FALSE(carried_of(verdicts));
  EXPECT_TRUE(carried_of(v1::Carried()));
}

TEST(CarriedMessage, IsSmallForASmallSite) {
  Carried carried;
  carried.done = at(10);
  carried.received = at(10);
  carried.open = {at(10.2), {{mac(1), at(10.1), at(10.19)}}};
  carried.devices = {1, {{"02:52:4c:00:00:01", 1}}};
  EXPECT_LT(carried_message(carried).ByteSizeLong(), 100U);
}

}  // namespace
}  // namespace rayloc::carried_test
