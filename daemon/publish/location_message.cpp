#include "daemon/publish/location_message.h"

#include "daemon/publish/proto_time.h"
#include "daemon/publish/topic.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

void set_point(const Vec3d& from, v1::Point* to) {
  to->set_x(from.x);
  to->set_y(from.y);
  to->set_z(from.z);
}

// The same target, instant and kind give the same id, live and in every replay.
std::string event_id(const LocationEstimate& estimate, const LocationContext& context) {
  const char* kind = context.kind == v1::LOCATION_KIND_FILTERED ? "filtered" : "snapshot";
  return target_component(context.target) + "-" +
         std::to_string(estimate.time.time_since_epoch().count()) + "-" + kind;
}

void set_position(const LocationEstimate& estimate, v1::Location* message) {
  message->set_mode(v1::FIX_MODE_2D);
  set_point(*estimate.position, message->mutable_position());
  if (estimate.is_uncertainty_stated) {
    message->mutable_position_covariance()->Add(estimate.covariance.begin(),
                                                estimate.covariance.end());
    message->set_accuracy_m(estimate.accuracy_m);
    message->set_accuracy_confidence(estimate.accuracy_confidence);
  }
  for (const Hypothesis& hypothesis : estimate.hypotheses) {
    v1::Hypothesis* to = message->add_hypotheses();
    set_point(hypothesis.position, to->mutable_position());
    to->mutable_position_covariance()->Add(hypothesis.covariance.begin(),
                                           hypothesis.covariance.end());
    to->set_weight(hypothesis.weight);
  }
  message->set_residual_probability(estimate.residual_probability);
}

void set_quality(const LocationEstimate& estimate,
                 const LocationContext& context,
                 v1::Quality* quality) {
  quality->set_method(context.method);
  quality->set_frames(static_cast<std::uint32_t>(estimate.frames_used));
  quality->set_access_points(static_cast<std::uint32_t>(estimate.access_points_used));
  quality->set_antennas(static_cast<std::uint32_t>(estimate.antennas_used));
  if (estimate.frames_used > 0) {
    quality->set_snr_db(estimate.snr_db);
  }
  quality->set_iterations(static_cast<std::uint32_t>(estimate.iterations));
  quality->set_starts(static_cast<std::uint32_t>(estimate.starts));
  if (estimate.position) {
    quality->set_loss(estimate.loss);
    if (estimate.model_residual_db) {
      quality->set_model_residual_db(*estimate.model_residual_db);
    }
    quality->set_ambiguous(estimate.ambiguous);
  } else {
    quality->set_no_fix_reason(estimate.reason);
  }
  for (const std::string& warning : estimate.warnings) {
    quality->add_warnings(warning);
  }
}

v1::TrackState to_proto(TrackState state) {
  switch (state) {
    case TrackState::kTentative:
      return v1::TRACK_STATE_TENTATIVE;
    case TrackState::kConfirmed:
      return v1::TRACK_STATE_CONFIRMED;
    case TrackState::kCoasting:
      return v1::TRACK_STATE_COASTING;
    case TrackState::kLost:
      return v1::TRACK_STATE_LOST;
  }
  return v1::TRACK_STATE_UNSPECIFIED;
}

}  // namespace

v1::Location location_message(const LocationEstimate& estimate, const LocationContext& context) {
  v1::Location message;
  message.set_event_id(event_id(estimate, context));
  message.set_kind(context.kind);
  *message.mutable_time() = to_proto(estimate.time);
  *message.mutable_capture_start() = to_proto(estimate.capture_start);
  *message.mutable_capture_end() = to_proto(estimate.capture_end);
  *message.mutable_target() = context.target;
  *message.mutable_frame() = context.frame;
  if (estimate.position) {
    set_position(estimate, &message);
  } else {
    message.set_mode(v1::FIX_MODE_NO_FIX);
    message.set_residual_probability(1.0);
  }
  *message.mutable_valid_for() = to_proto(context.valid_for);
  set_quality(estimate, context, message.mutable_quality());
  return message;
}

v1::Location filtered_message(const FilteredEstimate& estimate, LocationContext context) {
  context.kind = v1::LOCATION_KIND_FILTERED;
  v1::Location message = location_message(estimate.location, context);
  if (estimate.predicted && estimate.location.position) {
    message.set_mode(v1::FIX_MODE_PREDICTED);
  }
  message.set_track_state(to_proto(estimate.state));
  if (estimate.velocity) {
    message.mutable_velocity()->set_x(estimate.velocity->x);
    message.mutable_velocity()->set_y(estimate.velocity->y);
  }
  return message;
}

v1::TrackEvent track_event(const FilteredEstimate& estimate, const v1::Target& target) {
  RAYLOC_CHECK(estimate.transition && target.has_track());
  const TrackTransition& transition = *estimate.transition;
  v1::TrackEvent event;
  if (transition.before) {
    event.set_previous_state(to_proto(*transition.before));
  }
  event.set_state(to_proto(transition.after));
  // Numbers of tracks are those of one run, and would differ in a replay that begins later.
  event.set_event_id(target_component(target) + "-" +
                     std::to_string(transition.time.time_since_epoch().count()) + "-track-" +
                     std::to_string(event.previous_state()) + "-" + std::to_string(event.state()));
  *event.mutable_time() = to_proto(transition.time);
  *event.mutable_target() = target;
  if (estimate.location.position) {
    set_point(*estimate.location.position, event.mutable_position());
  }
  event.set_reason(transition.reason);
  return event;
}

}  // namespace rayloc
