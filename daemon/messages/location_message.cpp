#include "daemon/messages/location_message.h"

#include <string>

#include "daemon/messages/proto_time.h"
#include "daemon/messages/topic.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

void set_point(const Vec3d& from, v1::Point* to) {
  to->set_x(from.x);
  to->set_y(from.y);
  to->set_z(from.z);
}

v1::Frame frame_of(const LocationContext& context) {
  v1::Frame frame;
  frame.set_crs("local");
  frame.set_site(context.site);
  frame.set_scene_hash(context.scene_hash);
  frame.set_calibration_id(context.calibration_id);
  return frame;
}

// Prefix of every id: the same target and instant give the same id, live and in every replay.
std::string id_of(const Target& target, Timestamp time) {
  return target_component(target) + "-" + std::to_string(time.time_since_epoch().count());
}

void set_position(const LocationEstimate& estimate, v1::Location* message) {
  message->set_mode(estimate.is_height_estimated ? v1::FIX_MODE_3D : v1::FIX_MODE_2D);
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

void set_quality(const LocationEstimate& estimate, v1::Quality* quality) {
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

v1::TrackState track_state_proto(TrackState state) {
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

void set_tracked(const Location& location, v1::Location* message) {
  const Tracked& tracked = *location.tracked;
  if (tracked.is_predicted && location.estimate.position) {
    message->set_mode(v1::FIX_MODE_PREDICTED);
  }
  message->set_track_state(track_state_proto(tracked.state));
  if (tracked.velocity) {
    message->mutable_velocity()->set_x(tracked.velocity->x);
    message->mutable_velocity()->set_y(tracked.velocity->y);
  }
}

struct ZoneEventName {
  v1::ZoneEventKind kind;
  const char* word;  // word in ids
};

ZoneEventName name_of(ZoneEventKind kind) {
  switch (kind) {
    case ZoneEventKind::kEntered:
      return {v1::ZONE_EVENT_KIND_ENTERED, "entered"};
    case ZoneEventKind::kLeft:
      return {v1::ZONE_EVENT_KIND_LEFT, "left"};
    case ZoneEventKind::kDwelled:
      return {v1::ZONE_EVENT_KIND_DWELLED, "dwelled"};
  }
  return {v1::ZONE_EVENT_KIND_UNSPECIFIED, ""};
}

}  // namespace

v1::Target target_message(const Target& target) {
  v1::Target message;
  message.set_kind(target.kind == TargetKind::kPerson ? v1::TARGET_KIND_PERSON
                                                      : v1::TARGET_KIND_DEVICE);
  if (target.is_hashed) {
    message.set_hashed_mac(target.address);
  } else if (!target.address.empty()) {
    message.set_mac(target.address);
  }
  if (target.track) {
    message.set_track(*target.track);
  }
  message.set_name(target.name);
  return message;
}

Target target_of(const v1::Target& message) {
  Target target;
  target.kind =
      message.kind() == v1::TARGET_KIND_PERSON ? TargetKind::kPerson : TargetKind::kDevice;
  target.is_hashed = message.has_hashed_mac();
  target.address = target.is_hashed ? message.hashed_mac() : message.mac();
  if (message.has_track()) {
    target.track = message.track();
  }
  target.name = message.name();
  return target;
}

v1::Location location_message(const Location& location, Duration clock_ahead) {
  const LocationEstimate& estimate = location.estimate;
  v1::Location message;
  message.set_event_id(id_of(location.target, estimate.time) +
                       (location.is_filtered() ? "-filtered" : "-snapshot"));
  message.set_kind(location.is_filtered() ? v1::LOCATION_KIND_FILTERED
                                          : v1::LOCATION_KIND_SNAPSHOT);
  *message.mutable_time() = to_proto(estimate.time + clock_ahead);
  *message.mutable_capture_start() = to_proto(estimate.capture_start + clock_ahead);
  *message.mutable_capture_end() = to_proto(estimate.capture_end + clock_ahead);
  *message.mutable_target() = target_message(location.target);
  *message.mutable_frame() = frame_of(location.context);
  if (estimate.position) {
    set_position(estimate, &message);
  } else {
    message.set_mode(v1::FIX_MODE_NO_FIX);
    message.set_residual_probability(1.0);
  }
  if (location.tracked) {
    set_tracked(location, &message);
  }
  for (const ZoneProbability& zone : location.zones) {
    v1::ZoneProbability* to = message.add_zones();
    to->set_zone(zone.zone);
    to->set_probability(zone.probability);
  }
  *message.mutable_valid_for() = to_proto(location.context.valid_for);
  message.mutable_quality()->set_method(location.context.method);
  set_quality(estimate, message.mutable_quality());
  return message;
}

v1::Location compared_message(const Location& location, Duration clock_ahead) {
  v1::Location message = location_message(location, clock_ahead);
  message.set_event_id(message.event_id() + "-" + location.context.method);
  return message;
}

v1::TrackEvent event_message(const TrackEvent& event, Duration clock_ahead) {
  RAYLOC_CHECK(event.target.track);
  const TrackTransition& transition = event.transition;
  v1::TrackEvent message;
  if (transition.before) {
    message.set_previous_state(track_state_proto(*transition.before));
  }
  message.set_state(track_state_proto(transition.after));
  // Track numbers are those of one run, and would differ in a replay that begins later.
  message.set_event_id(id_of(event.target, transition.time) + "-track-" +
                       std::to_string(message.previous_state()) + "-" +
                       std::to_string(message.state()));
  *message.mutable_time() = to_proto(transition.time + clock_ahead);
  *message.mutable_target() = target_message(event.target);
  if (event.position) {
    set_point(*event.position, message.mutable_position());
  }
  message.set_reason(transition.reason);
  return message;
}

v1::ZoneEvent event_message(const ZoneEvent& event, Duration clock_ahead) {
  const ZoneEventName name = name_of(event.kind);
  v1::ZoneEvent message;
  message.set_event_id(id_of(event.target, event.time) + "-zone-" + event.zone + "-" + name.word);
  message.set_kind(name.kind);
  *message.mutable_time() = to_proto(event.time + clock_ahead);
  message.set_zone(event.zone);
  *message.mutable_target() = target_message(event.target);
  message.set_probability(event.probability);
  if (event.kind != ZoneEventKind::kEntered) {
    *message.mutable_dwell() = to_proto(event.dwell);
  }
  message.set_reason(event.reason);
  for (const Target& target : event.inside) {
    *message.add_inside() = target_message(target);
  }
  message.set_occupancy(static_cast<std::uint32_t>(event.inside.size()));
  return message;
}

}  // namespace rayloc
