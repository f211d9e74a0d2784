#include "daemon/publish/location_message.h"

#include <gtest/gtest.h>

namespace rayloc {
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

LocationContext context() {
  LocationContext context;
  context.target.set_kind(v1::TARGET_KIND_DEVICE);
  context.target.set_mac("02:52:4c:00:00:01");
  context.frame.set_crs("local");
  context.method = "rayloc";
  context.valid_for = std::chrono::milliseconds(450);
  return context;
}

TEST(LocationMessage, CarriesTheFix) {
  const v1::Location message = location_message(fix(), context());
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
  const v1::Location message = location_message(estimate, context());
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
  const v1::Location message = location_message(estimate, context());
  EXPECT_EQ(message.mode(), v1::FIX_MODE_2D);
  EXPECT_EQ(message.position().y(), -2.0);
  EXPECT_EQ(message.position_covariance_size(), 0);
  EXPECT_FALSE(message.has_accuracy_m());
  EXPECT_FALSE(message.has_accuracy_confidence());
  EXPECT_EQ(message.residual_probability(), 1.0);
  EXPECT_EQ(message.quality().iterations(), 100U);
  EXPECT_EQ(message.quality().starts(), 8U);
}

TEST(LocationMessage, IdTellsTargetInstantAndKindApart) {
  LocationContext filtered = context();
  filtered.kind = v1::LOCATION_KIND_FILTERED;
  LocationContext person = context();
  person.target.clear_address();
  person.target.set_kind(v1::TARGET_KIND_PERSON);
  person.target.set_track(3);
  LocationEstimate later = fix();
  later.time += std::chrono::nanoseconds(1);
  const std::string id = location_message(fix(), context()).event_id();
  EXPECT_EQ(location_message(fix(), context()).event_id(), id);
  EXPECT_NE(location_message(fix(), filtered).event_id(), id);
  EXPECT_NE(location_message(later, context()).event_id(), id);
  EXPECT_EQ(location_message(fix(), person).event_id(), "person-3-1718000958500000000-snapshot");
}

TEST(LocationMessage, StatesTheTrack) {
  FilteredEstimate filtered;
  filtered.location.position = Vec3d{1.0, 2.0, 1.2};
  filtered.location.time = Timestamp(std::chrono::seconds(5));
  filtered.state = TrackState::kConfirmed;
  filtered.velocity = Vec3d{0.5, -0.25, 0.0};
  LocationContext context;
  context.target.set_mac("02:52:4c:00:00:01");
  v1::Location message = filtered_message(filtered, context);
  EXPECT_EQ(message.kind(), v1::LOCATION_KIND_FILTERED);
  EXPECT_EQ(message.event_id(), "02:52:4c:00:00:01-5000000000-filtered");
  EXPECT_EQ(message.mode(), v1::FIX_MODE_2D);
  EXPECT_EQ(message.track_state(), v1::TRACK_STATE_CONFIRMED);
  EXPECT_EQ(message.velocity().x(), 0.5);
  EXPECT_EQ(message.velocity().y(), -0.25);
  EXPECT_FALSE(message.quality().has_model_residual_db());

  filtered.state = TrackState::kCoasting;
  filtered.predicted = true;
  filtered.velocity.reset();
  message = filtered_message(filtered, context);
  EXPECT_EQ(message.mode(), v1::FIX_MODE_PREDICTED);
  EXPECT_EQ(message.track_state(), v1::TRACK_STATE_COASTING);
  EXPECT_FALSE(message.has_velocity());
}

TEST(TrackEvent, StatesTheTransition) {
  FilteredEstimate filtered;
  filtered.location.position = Vec3d{1.0, 2.0, 1.2};
  filtered.transition = TrackTransition{
      Timestamp(std::chrono::seconds(5)), std::nullopt, TrackState::kTentative, "heard at last"};
  v1::Target target;
  target.set_mac("02:52:4c:00:00:01");
  target.set_track(7);
  const v1::TrackEvent begin = track_event(filtered, target);
  EXPECT_EQ(begin.event_id(), "02:52:4c:00:00:01-5000000000-track-0-1");
  EXPECT_EQ(begin.time().seconds(), 5);
  EXPECT_EQ(begin.target().track(), 7U);
  EXPECT_EQ(begin.previous_state(), v1::TRACK_STATE_UNSPECIFIED);
  EXPECT_EQ(begin.state(), v1::TRACK_STATE_TENTATIVE);
  EXPECT_EQ(begin.position().y(), 2.0);
  EXPECT_EQ(begin.reason(), "heard at last");

  filtered.location.position.reset();
  filtered.transition = TrackTransition{
      Timestamp(std::chrono::seconds(9)), TrackState::kCoasting, TrackState::kLost, "silent"};
  const v1::TrackEvent end = track_event(filtered, target);
  EXPECT_EQ(end.event_id(), "02:52:4c:00:00:01-9000000000-track-3-4");
  EXPECT_EQ(end.previous_state(), v1::TRACK_STATE_COASTING);
  EXPECT_EQ(end.state(), v1::TRACK_STATE_LOST);
  EXPECT_FALSE(end.has_position());
}

}  // namespace
}  // namespace rayloc
