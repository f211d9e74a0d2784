#include "daemon/pipeline/zones/zone_watch.h"

#include <algorithm>
#include <iterator>

#include <spdlog/fmt/fmt.h>

#include "daemon/messages/topic.h"
#include "daemon/pipeline/zones/gaussian_in_polygon.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

PlanarGaussian planar(const Hypothesis& hypothesis) {
  const auto& covariance = hypothesis.covariance;
  return {
      {hypothesis.position.x, hypothesis.position.y}, covariance[0], covariance[1], covariance[4]};
}

}  // namespace

void fill_zones(const std::vector<SiteZone>& zones, Location& location) {
  location.zones.clear();
  const LocationEstimate& estimate = location.estimate;
  if (!estimate.position || estimate.hypotheses.empty()) {
    return;
  }
  for (const SiteZone& zone : zones) {
    double probability = 0.0;
    for (const Hypothesis& hypothesis : estimate.hypotheses) {
      probability += hypothesis.weight * gaussian_in_polygon(planar(hypothesis), zone.polygon);
    }
    location.zones.push_back({zone.name, std::clamp(probability, 0.0, 1.0)});
  }
}

// A zone that the site no longer has is dropped, and a new one is empty.
ZoneWatch::ZoneWatch(std::vector<SiteZone> zones, const ZoneStays& stays, Timestamp done)
    : ZoneWatch(std::move(zones)) {
  done_ = done;
  for (const ZoneStays::Occupant& occupant : stays.occupants) {
    Watched& watched = targets_[target_component(occupant.target)];
    watched.target = occupant.target;
    watched.received = occupant.received;
    watched.stays.resize(zones_.size());
  }
  for (std::size_t old = 0; old < stays.zones.size(); ++old) {
    const auto found = std::find_if(zones_.begin(), zones_.end(), [&](const SiteZone& zone) {
      return zone.name == stays.zones[old];
    });
    if (found == zones_.end()) {
      continue;
    }
    const auto zone = static_cast<std::size_t>(found - zones_.begin());
    for (const ZoneStays::Occupant& occupant : stays.occupants) {
      targets_.at(target_component(occupant.target)).stays[zone] = occupant.stays[old];
    }
    for (const std::size_t inside : stays.inside[old]) {
      inside_[zone].push_back(target_component(stays.occupants[inside].target));
    }
  }
}

ZoneStays ZoneWatch::stays() const {
  ZoneStays stays;
  stays.inside.resize(zones_.size());
  stays.zones.reserve(zones_.size());
  for (const SiteZone& zone : zones_) {
    stays.zones.push_back(zone.name);
  }
  std::map<std::string, std::size_t> number;
  stays.occupants.reserve(targets_.size());
  for (const auto& [key, watched] : targets_) {
    number[key] = stays.occupants.size();
    stays.occupants.push_back({watched.target, watched.received, watched.stays});
  }
  for (std::size_t zone = 0; zone < zones_.size(); ++zone) {
    stays.inside[zone].reserve(inside_[zone].size());
    for (const std::string& key : inside_[zone]) {
      stays.inside[zone].push_back(number.at(key));
    }
  }
  return stays;
}

void ZoneWatch::see(const Location& location, const std::optional<MacAddress>& transmitter) {
  if (zones_.empty() || !location.is_filtered()) {
    return;
  }
  if (location.estimate.time < done_) {
    const auto continued = targets_.find(target_component(location.target));
    if (transmitter && continued != targets_.end()) {
      continued->second.transmitter = transmitter;
    }
    return;
  }
  const TrackState state = location.tracked->state;
  const bool is_lost = state == TrackState::kLost;
  const bool is_trusted = state == TrackState::kConfirmed || state == TrackState::kCoasting;
  if (!is_lost && !(is_trusted && !location.zones.empty())) {
    return;
  }
  Sighting sighting{location.target, {}, is_lost, transmitter};
  for (const ZoneProbability& zone : location.zones) {
    sighting.probability.push_back(zone.probability);
  }
  RAYLOC_CHECK(sighting.probability.empty() || sighting.probability.size() == zones_.size());
  held_.emplace(std::pair(location.estimate.time, target_component(location.target)),
                std::move(sighting));
}

void ZoneWatch::take_before(Timestamp time, const IsWaiting& is_waiting) {
  while (!held_.empty() && held_.begin()->first.first < time) {
    const auto& [key, sighting] = *held_.begin();
    take(key.first, key.second, sighting, is_waiting);
    held_.erase(held_.begin());
  }
}

void ZoneWatch::advance(Timestamp time,
                        std::vector<ZoneEvent>& events,
                        const IsWaiting& is_waiting) {
  take_before(time, is_waiting);
  forget_silent(time, is_waiting);
  keep_waiting(time, is_waiting);
  give_out(events);
}

void ZoneWatch::restart(const std::string& reason, std::vector<ZoneEvent>& events) {
  take_before(Timestamp::max(), {});
  done_ = Timestamp::min();
  Timestamp last = Timestamp::min();
  for (const auto& [key, watched] : targets_) {
    last = std::max(last, watched.received);
  }
  while (!targets_.empty()) {
    leave_all(targets_.begin(), last, reason);
  }
  give_out(events);
}

void ZoneWatch::give_out(std::vector<ZoneEvent>& events) {
  std::move(pending_.begin(), pending_.end(), std::back_inserter(events));
  pending_.clear();
}

void ZoneWatch::take(Timestamp time,
                     const std::string& key,
                     const Sighting& sighting,
                     const IsWaiting& is_waiting) {
  forget_silent(time, is_waiting);
  if (sighting.is_lost) {
    if (const auto lost = targets_.find(key); lost != targets_.end()) {
      leave_all(lost, std::max(time, lost->second.waited), "its track was lost");
    }
    return;
  }
  const auto watched = watched_of(key, sighting);
  time = std::max(time, watched->second.waited);
  watched->second.target = sighting.target;
  watched->second.received = time;
  watched->second.stays.resize(zones_.size());
  for (std::size_t zone = 0; zone < zones_.size(); ++zone) {
    watched->second.stays[zone].probability = sighting.probability[zone];
    judge(zone, *watched, time);
  }
}

// The target of the sighting. A new target replaces the one that its transmitter had before, under
// another name: that one becomes silent.
ZoneWatch::Targets::iterator ZoneWatch::watched_of(const std::string& key,
                                                   const Sighting& sighting) {
  const auto [watched, is_new] = targets_.try_emplace(key);
  if (!sighting.transmitter) {
    return watched;
  }
  if (is_new) {
    for (auto& [other, before] : targets_) {
      if (before.transmitter == sighting.transmitter) {
        watched->second.waited = std::max(watched->second.waited, before.waited);
        before.transmitter.reset();
      }
    }
  }
  watched->second.transmitter = sighting.transmitter;
  return watched;
}

void ZoneWatch::judge(std::size_t zone, Targets::value_type& target, Timestamp time) {
  const SiteZone& rules = zones_[zone];
  ZoneStay& stay = target.second.stays[zone];
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
      add_event(ZoneEventKind::kEntered, zone, target, time);
    }
  }
  if (stay.is_inside && !stay.has_dwelled && time - stay.entered >= rules.dwell_after) {
    stay.has_dwelled = true;
    add_event(ZoneEventKind::kDwelled, zone, target, time);
  }
}

void ZoneWatch::leave(std::size_t zone,
                      Targets::value_type& target,
                      Timestamp time,
                      const std::string& reason) {
  std::erase(inside_[zone], target.first);
  add_event(ZoneEventKind::kLeft, zone, target, time).reason = reason;
  ZoneStay& stay = target.second.stays[zone];
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

// Removes targets whose silence has lasted long enough at `before`, the longest silent first.
void ZoneWatch::forget_silent(Timestamp before, const IsWaiting& is_waiting) {
  while (!targets_.empty()) {
    const auto silent =
        std::min_element(targets_.begin(), targets_.end(), [](const auto& a, const auto& b) {
          return a.second.received < b.second.received;
        });
    const Timestamp given_up = silent->second.received + kSilence;
    if (given_up >= before) {
      return;
    }
    if (silent->second.waits(is_waiting)) {
      silent->second.received = before;
      continue;
    }
    leave_all(silent,
              given_up,
              fmt::format("no frame of it was received for {:g} s", to_seconds(kSilence)));
  }
}

// A target whose burst waits has been received up to `time`: the burst has no earlier frame.
void ZoneWatch::keep_waiting(Timestamp time, const IsWaiting& is_waiting) {
  for (auto& [key, watched] : targets_) {
    if (watched.waits(is_waiting)) {
      watched.received = watched.waited = time;
    }
  }
}

ZoneEvent& ZoneWatch::add_event(ZoneEventKind kind,
                                std::size_t zone,
                                const Targets::value_type& target,
                                Timestamp time) {
  const ZoneStay& stay = target.second.stays[zone];
  ZoneEvent& event = pending_.emplace_back();
  event.kind = kind;
  event.time = time;
  event.zone = zones_[zone].name;
  event.target = target.second.target;
  event.probability = stay.probability;
  event.dwell = kind == ZoneEventKind::kEntered ? Duration::zero() : time - stay.entered;
  for (const std::string& key : inside_[zone]) {
    event.inside.push_back(targets_.at(key).target);
  }
  return event;
}

}  // namespace rayloc
