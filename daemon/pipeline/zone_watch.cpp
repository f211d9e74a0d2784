#include "daemon/pipeline/zone_watch.h"

#include <algorithm>
#include <array>
#include <iterator>

#include <spdlog/fmt/fmt.h>

#include "daemon/publish/proto_time.h"
#include "daemon/publish/topic.h"
#include "engine/base/check.h"
#include "engine/base/gaussian_in_polygon.h"

namespace rayloc {
namespace {

PlanarGaussian planar(const v1::Hypothesis& hypothesis) {
  const auto& covariance = hypothesis.position_covariance();
  PlanarGaussian gaussian{{hypothesis.position().x(), hypothesis.position().y()}};
  if (covariance.size() == 9) {
    gaussian.variance_x = covariance[0];
    gaussian.covariance_xy = covariance[1];
    gaussian.variance_y = covariance[4];
  }
  return gaussian;
}

const char* word(v1::ZoneEventKind kind) {
  switch (kind) {
    case v1::ZONE_EVENT_KIND_ENTERED:
      return "entered";
    case v1::ZONE_EVENT_KIND_LEFT:
      return "left";
    default:
      return "dwelled";
  }
}

}  // namespace

void fill_zones(const std::vector<SiteZone>& zones, v1::Location& location) {
  location.clear_zones();
  if (location.hypotheses().empty()) {
    return;
  }
  for (const SiteZone& zone : zones) {
    double probability = 0.0;
    for (const v1::Hypothesis& hypothesis : location.hypotheses()) {
      probability += hypothesis.weight() * gaussian_in_polygon(planar(hypothesis), zone.polygon);
    }
    v1::ZoneProbability* out = location.add_zones();
    out->set_zone(zone.name);
    out->set_probability(std::clamp(probability, 0.0, 1.0));
  }
}

void ZoneWatch::see(const v1::Location& location) {
  const bool is_lost = location.track_state() == v1::TRACK_STATE_LOST;
  const bool is_believed = location.track_state() == v1::TRACK_STATE_CONFIRMED ||
                           location.track_state() == v1::TRACK_STATE_COASTING;
  if (zones_.empty() || location.kind() != v1::LOCATION_KIND_FILTERED ||
      !(is_lost || (is_believed && !location.zones().empty()))) {
    return;
  }
  Sighting sighting{location.target(), {}, is_lost};
  for (const v1::ZoneProbability& zone : location.zones()) {
    sighting.probability.push_back(zone.probability());
  }
  RAYLOC_CHECK(sighting.probability.empty() || sighting.probability.size() == zones_.size());
  held_.emplace(std::pair(from_proto(location.time()), target_component(location.target())),
                std::move(sighting));
}

void ZoneWatch::take_before(Timestamp time) {
  while (!held_.empty() && held_.begin()->first.first < time) {
    const auto& [key, sighting] = *held_.begin();
    take(key.first, key.second, sighting);
    held_.erase(held_.begin());
  }
}

void ZoneWatch::advance(Timestamp time, std::vector<v1::ZoneEvent>& events) {
  take_before(time);
  forget_silent(time);
  give_out(events);
}

void ZoneWatch::restart(const std::string& reason, std::vector<v1::ZoneEvent>& events) {
  take_before(Timestamp::max());
  Timestamp last = Timestamp::min();
  for (const auto& [key, watched] : targets_) {
    last = std::max(last, watched.heard);
  }
  while (!targets_.empty()) {
    leave_all(targets_.begin(), last, reason);
  }
  give_out(events);
}

void ZoneWatch::give_out(std::vector<v1::ZoneEvent>& events) {
  std::move(said_.begin(), said_.end(), std::back_inserter(events));
  said_.clear();
}

void ZoneWatch::take(Timestamp time, const std::string& key, const Sighting& sighting) {
  forget_silent(time);
  if (sighting.is_lost) {
    if (const auto lost = targets_.find(key); lost != targets_.end()) {
      leave_all(lost, time, "its track was lost");
    }
    return;
  }
  const auto watched = targets_.try_emplace(key).first;
  watched->second.target = sighting.target;
  watched->second.heard = time;
  watched->second.stays.resize(zones_.size());
  for (std::size_t zone = 0; zone < zones_.size(); ++zone) {
    watched->second.stays[zone].probability = sighting.probability[zone];
    judge(zone, *watched, time);
  }
}

void ZoneWatch::judge(std::size_t zone, Targets::value_type& target, Timestamp time) {
  const SiteZone& rules = zones_[zone];
  Stay& stay = target.second.stays[zone];
  const bool is_across = stay.is_inside ? stay.probability <= rules.leave_probability
                                        : stay.probability >= rules.enter_probability;
  if (!is_across) {
    stay.crossing.reset();
  } else {
    stay.crossing = stay.crossing.value_or(time);
    if (stay.is_inside && time - *stay.crossing >= rules.leave_after) {
      leave(zone,
            target,
            time,
            fmt::format("its probability was at most {:g} for {:g} s",
                        rules.leave_probability,
                        to_seconds(rules.leave_after)));
    } else if (!stay.is_inside && time - *stay.crossing >= rules.enter_after) {
      stay = {true, false, std::nullopt, time, stay.probability};
      inside_[zone].push_back(target.first);
      say(v1::ZONE_EVENT_KIND_ENTERED, zone, target, time);
    }
  }
  if (stay.is_inside && !stay.has_dwelled && time - stay.entered >= rules.dwell_after) {
    stay.has_dwelled = true;
    say(v1::ZONE_EVENT_KIND_DWELLED, zone, target, time);
  }
}

void ZoneWatch::leave(std::size_t zone,
                      Targets::value_type& target,
                      Timestamp time,
                      const std::string& reason) {
  std::erase(inside_[zone], target.first);
  say(v1::ZONE_EVENT_KIND_LEFT, zone, target, time).set_reason(reason);
  Stay& stay = target.second.stays[zone];
  stay.is_inside = false;
  stay.crossing.reset();
}

void ZoneWatch::leave_all(Targets::iterator target, Timestamp time, const std::string& reason) {
  for (std::size_t zone = 0; zone < zones_.size(); ++zone) {
    if (target->second.stays[zone].is_inside) {
      leave(zone, *target, time, reason);
    }
  }
  targets_.erase(target);
}

// Those whose silence has lasted long enough at `before`, the longest silent first.
void ZoneWatch::forget_silent(Timestamp before) {
  while (!targets_.empty()) {
    const auto silent =
        std::min_element(targets_.begin(), targets_.end(), [](const auto& a, const auto& b) {
          return a.second.heard < b.second.heard;
        });
    const Timestamp given_up = silent->second.heard + kSilence;
    if (given_up >= before) {
      return;
    }
    leave_all(
        silent, given_up, fmt::format("nothing was heard of it for {:g} s", to_seconds(kSilence)));
  }
}

v1::ZoneEvent& ZoneWatch::say(v1::ZoneEventKind kind,
                              std::size_t zone,
                              const Targets::value_type& target,
                              Timestamp time) {
  v1::ZoneEvent& event = said_.emplace_back();
  const Stay& stay = target.second.stays[zone];
  event.set_event_id(target.first + "-" + std::to_string(time.time_since_epoch().count()) +
                     "-zone-" + zones_[zone].name + "-" + word(kind));
  event.set_kind(kind);
  *event.mutable_time() = to_proto(time);
  event.set_zone(zones_[zone].name);
  *event.mutable_target() = target.second.target;
  event.set_probability(stay.probability);
  if (kind != v1::ZONE_EVENT_KIND_ENTERED) {
    *event.mutable_dwell() = to_proto(time - stay.entered);
  }
  for (const std::string& key : inside_[zone]) {
    *event.add_inside() = targets_.at(key).target;
  }
  event.set_occupancy(static_cast<std::uint32_t>(inside_[zone].size()));
  return event;
}

}  // namespace rayloc
