#include "daemon/messages/location_message.h"

#include <gtest/gtest.h>

namespace rayloc::location_message_test {
namespace {

LocationEstimate fix() {
  LocationEstimate estimate;
  estimate.position = Vec3d{1.0, -2.0, 1.2};
  estimate.covariance = {0.04, 0.0, 0.0, 0.0, 0.09, 0.0, 0.0, 0.0, 0.01};
  estimate.accuracy_m = 0.6;
  estimate.hypotheses = {{{1.0, -2.0, 1.2}, estimate.covariance, 0.7},
                         {{3.0, 1.0, 1.2}, estimate.covariance, 0.2}};
  estimate.residual_probability = 0.1;
  estimate.frames_used = 12;
  estimate.access_points_used = 3;
  estimate.antennas_used = 9;
  estimate.time = Timestamp(std::chrono::milliseconds(1'718'000'958'500));
  estimate.capture_start = estimate.time - std::chrono::milliseconds(90);
  estimate.capture_end = estimate.time + std::chrono::milliseconds(90);
  return estimate;
}

Location of(LocationEstimate estimate) {
  Location location;
  location.estimate = std::move(estimate);
  location.target.address = "02:52:4c:00:00:01";
  location.context = {"office", "c0ffee", "cal-1", "rayloc", std::chrono::milliseconds(450)};
  return location;
}

TEST(LocationMessage, CarriesTheFix) {
  const v1::Location message = location_message(of(fix()));
  EXPECT_EQ(message.mode(), v1::FIX_MODE_2D);
  EXPECT_EQ(message.kind(), v1::LOCATION_KIND_SNAPSHOT);
  EXPECT_EQ(message.position().y(), -2.0);
  ASSERT_EQ(message.position_covariance_size(), 9);
  EXPECT_EQ(message.position_covariance(4), 0.09);
  EXPECT_EQ(message.accuracy_m(), 0.6);
  EXPECT_EQ(message.accuracy_confidence(), 0.95);
  ASSERT_EQ(message.hypotheses_size(), 2);
  EXPECT_EQ(message.hypotheses(1).position().x(), 3.0);
  EXPECT_EQ(message.time().seconds(), 1'718'000'958);
  EXPECT_EQ(message.time().nanos(), 500'000'000);
  EXPECT_EQ(message.valid_for().nanos(), 450'000'000);
  EXPECT_EQ(message.quality().antennas(), 9U);
  EXPECT_EQ(message.event_id(), "02:52:4c:00:00:01-1718000958500000000-snapshot");
}

TEST(LocationMessage, NoFixHasNoPositionAndAReason) {
  LocationEstimate estimate = fix();
  estimate.position.reset();
  estimate.reason = "no usable frame";
  const v1::Location message = location_message(of(estimate));
  EXPECT_EQ(message.mode(), v1::FIX_MODE_NO_FIX);
  EXPECT_FALSE(message.has_position());
  EXPECT_FALSE(message.has_accuracy_m());
  EXPECT_EQ(message.position_covariance_size(), 0);
  EXPECT_EQ(message.hypotheses_size(), 0);
  EXPECT_EQ(message.residual_probability(), 1.0);
  EXPECT_EQ(message.quality().no_fix_reason(), "no usable frame");
}

TEST(LocationMessage, UncertaintyThatIsNotStatedIsAbsent) {
  LocationEstimate estimate = fix();
  estimate.is_uncertainty_stated = false;
  estimate.hypotheses.clear();
  estimate.residual_probability = 1.0;
  estimate.iterations = 100;
  estimate.starts = 8;
  const v1::Location message = location_message(of(estimate));
  EXPECT_EQ(message.mode(), v1::FIX_MODE_2D);
  EXPECT_EQ(message.position().y(), -2.0);
  EXPECT_EQ(message.position_covariance_size(), 0);
  EXPECT_FALSE(message.has_accuracy_m());
  EXPECT_FALSE(message.has_accuracy_confidence());
  EXPECT_EQ(message.residual_probability(), 1.0);
  EXPECT_EQ(message.quality().iterations(), 100U);
  EXPECT_EQ(message.quality().starts(), 8U);
}

TEST(LocationMessage, NamesTargetAndRoom) {
  Location location = of(fix());
  location.target.name = "phone";
  v1::Location message = location_message(location);
  EXPECT_EQ(message.target().kind(), v1::TARGET_KIND_DEVICE);
  EXPECT_EQ(message.target().mac(), "02:52:4c:00:00:01");
  EXPECT_EQ(message.target().name(), "phone");
  EXPECT_FALSE(message.target().has_track());
  EXPECT_EQ(message.frame().crs(), "local");
  EXPECT_EQ(message.frame().site(), "office");
  EXPECT_EQ(message.frame().scene_hash(), "c0ffee");
  EXPECT_EQ(message.frame().calibration_id(), "cal-1");
  EXPECT_EQ(message.quality().method(), "rayloc");

  location.target = {TargetKind::kDevice, "0123", true, 4, {}};
  message = location_message(location);
  EXPECT_EQ(message.target().hashed_mac(), "0123");
  EXPECT_FALSE(message.target().has_mac());
  EXPECT_EQ(message.target().track(), 4U);

  location.target = {TargetKind::kPerson, {}, false, 3, {}};
  message = location_message(location);
  EXPECT_EQ(message.target().kind(), v1::TARGET_KIND_PERSON);
  EXPECT_EQ(message.target().address_case(), v1::Target::ADDRESS_NOT_SET);
}

TEST(LocationMessage, HasZonesAndWarningsInTheirOrder) {
  Location location = of(fix());
  location.zones = {{"desk", 0.75}, {"door", 0.125}};
  location.estimate.warnings = {"first", "second"};
  const v1::Location message = location_message(location);
  ASSERT_EQ(message.zones_size(), 2);
  EXPECT_EQ(message.zones(0).zone(), "desk");
  EXPECT_EQ(message.zones(1).probability(), 0.125);
  ASSERT_EQ(message.quality().warnings_size(), 2);
  EXPECT_EQ(message.quality().warnings(1), "second");
}

TEST(LocationMessage, IdDistinguishesTargetInstantAndKind) {
  Location filtered = of(fix());
  filtered.tracked = Tracked{};
  Location person = of(fix());
  person.target = {TargetKind::kPerson, {}, false, 3, {}};
  LocationEstimate later = fix();
  later.time += std::chrono::nanoseconds(1);
  const std::string id = location_message(of(fix())).event_id();
  EXPECT_EQ(location_message(of(fix())).event_id(), id);
  EXPECT_NE(location_message(filtered).event_id(), id);
  EXPECT_NE(location_message(of(later)).event_id(), id);
  EXPECT_EQ(location_message(person).event_id(), "person-3-1718000958500000000-snapshot");
}

// After a clock was set, a replay still gives the same ids.
TEST(LocationMessage, HasClockTimesAndAnIdOfTheEventTime) {
  const v1::Location message = location_message(of(fix()), std::chrono::seconds(3600));
  EXPECT_EQ(message.event_id(), "02:52:4c:00:00:01-1718000958500000000-snapshot");
  EXPECT_EQ(message.time().seconds(), 1'718'004'558);
  EXPECT_EQ(message.capture_start().seconds(), 1'718'004'558);
  EXPECT_EQ(message.capture_start().nanos(), 410'000'000);
  EXPECT_EQ(message.capture_end().nanos(), 590'000'000);
  EXPECT_EQ(message.valid_for().nanos(), 450'000'000);
}

TEST(LocationMessage, StatesTheTrack) {
  FilteredEstimate estimate;
  estimate.location.position = Vec3d{1.0, 2.0, 1.2};
  estimate.location.time = Timestamp(std::chrono::seconds(5));
  estimate.state = TrackState::kConfirmed;
  estimate.velocity = Vec3d{0.5, -0.25, 0.0};
  Target target;
  target.address = "02:52:4c:00:00:01";
  v1::Location message = location_message(filtered_location(estimate, target, {}));
  EXPECT_EQ(message.kind(), v1::LOCATION_KIND_FILTERED);
  EXPECT_EQ(message.event_id(), "02:52:4c:00:00:01-5000000000-filtered");
  EXPECT_EQ(message.mode(), v1::FIX_MODE_2D);
  EXPECT_EQ(message.track_state(), v1::TRACK_STATE_CONFIRMED);
  EXPECT_EQ(message.velocity().x(), 0.5);
  EXPECT_EQ(message.velocity().y(), -0.25);
  EXPECT_FALSE(message.quality().has_model_residual_db());

  estimate.state = TrackState::kCoasting;
  estimate.predicted = true;
  estimate.velocity.reset();
  message = location_message(filtered_location(estimate, target, {}));
  EXPECT_EQ(message.mode(), v1::FIX_MODE_PREDICTED);
  EXPECT_EQ(message.track_state(), v1::TRACK_STATE_COASTING);
  EXPECT_FALSE(message.has_velocity());
}

TEST(EventMessage, StatesTheTransitionOfATrack) {
  TrackEvent event;
  event.target = {TargetKind::kDevice, "02:52:4c:00:00:01", false, 7, {}};
  event.position = Vec3d{1.0, 2.0, 1.2};
  event.transition = {
      Timestamp(std::chrono::seconds(5)), std::nullopt, TrackState::kTentative, "heard at last"};
  const v1::TrackEvent begin = event_message(event, std::chrono::seconds(2));
  EXPECT_EQ(begin.event_id(), "02:52:4c:00:00:01-5000000000-track-0-1");
  EXPECT_EQ(begin.time().seconds(), 7);
  EXPECT_EQ(begin.target().track(), 7U);
  EXPECT_EQ(begin.previous_state(), v1::TRACK_STATE_UNSPECIFIED);
  EXPECT_EQ(begin.state(), v1::TRACK_STATE_TENTATIVE);
  EXPECT_EQ(begin.position().y(), 2.0);
  EXPECT_EQ(begin.reason(), "heard at last");

  event.position.reset();
  event.transition = {
      Timestamp(std::chrono::seconds(9)), TrackState::kCoasting, TrackState::kLost, "silent"};
  const v1::TrackEvent end = event_message(event);
  EXPECT_EQ(end.event_id(), "02:52:4c:00:00:01-9000000000-track-3-4");
  EXPECT_EQ(end.previous_state(), v1::TRACK_STATE_COASTING);
  EXPECT_EQ(end.state(), v1::TRACK_STATE_LOST);
  EXPECT_FALSE(end.has_position());
}

TEST(EventMessage, ListsTheTargetsInAZone) {
  const Target a{TargetKind::kDevice, "a"};
  const Target b{TargetKind::kDevice, "b"};
  ZoneEvent event;
  event.time = Timestamp(std::chrono::milliseconds(4700));
  event.zone = "desk";
  event.target = a;
  event.probability = 0.9;
  event.inside = {b, a};
  const v1::ZoneEvent entered = event_message(event);
  EXPECT_EQ(entered.event_id(), "a-4700000000-zone-desk-entered");
  EXPECT_EQ(entered.kind(), v1::ZONE_EVENT_KIND_ENTERED);
  EXPECT_FALSE(entered.has_dwell());
  EXPECT_EQ(entered.occupancy(), 2U);
  ASSERT_EQ(entered.inside_size(), 2);
  EXPECT_EQ(entered.inside(0).mac(), "b");
  EXPECT_EQ(entered.probability(), 0.9);

  event.kind = ZoneEventKind::kLeft;
  event.dwell = std::chrono::milliseconds(4200);
  event.reason = "its track was lost";
  event.inside = {b};
  const v1::ZoneEvent left = event_message(event, std::chrono::seconds(10));
  EXPECT_EQ(left.event_id(), "a-4700000000-zone-desk-left");
  EXPECT_EQ(left.time().seconds(), 14);
  EXPECT_EQ(left.dwell().seconds(), 4);
  EXPECT_EQ(left.reason(), "its track was lost");
  EXPECT_EQ(left.occupancy(), 1U);

  event.kind = ZoneEventKind::kDwelled;
  EXPECT_EQ(event_message(event).event_id(), "a-4700000000-zone-desk-dwelled");
}

}  // namespace
}  // namespace rayloc::location_message_test
