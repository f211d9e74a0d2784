#include "daemon/pipeline/person_estimator.h"

#include <algorithm>
#include <span>

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/method_training.h"
#include "daemon/pipeline/person_numbers.h"
#include "daemon/pipeline/warm/carried.h"
#include "daemon/pipeline/watch/stamp_check.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"

namespace rayloc {
namespace {

bool is_fixed(const SiteTransmitter& transmitter) {
  return transmitter.role == TransmitterRole::kFixed;
}

// Index of a fixed transmitter among those of the site, from 1.
std::uint64_t number_of(const SiteTransmitter& fixed, const Site& site) {
  std::uint64_t number = 1;
  for (const SiteTransmitter& other : site.transmitters) {
    if (&other == &fixed) {
      break;
    }
    number += is_fixed(other) ? 1U : 0U;
  }
  return number;
}

// A successor continues with the number and the instants of its predecessor.
void go_on(const Carried& before, const MacAddress& fixed, PersonMethodInput& input) {
  input.numbered_before = before.done;
  for (const Carried::People& people : before.people) {
    if (people.transmitter == fixed) {
      input.first_number = people.number;
      input.last_moment = people.moment;
    }
  }
}

Target person(std::uint64_t track) { return {TargetKind::kPerson, {}, false, track, {}}; }

constexpr const char* kNoReference =
    "no recording of the empty room with this transmitter: run `rayloc reference` first";

// Result of a burst that cannot be evaluated.
LocationEstimate without_person(const Burst& burst, std::string reason) {
  LocationEstimate estimate;
  estimate.capture_start = burst.first;
  estimate.capture_end = burst.last;
  estimate.time = burst.first + (burst.last - burst.first) / 2;
  estimate.reason = std::move(reason);
  return estimate;
}

void warn(const std::vector<std::string>& warnings, std::span<Location> locations) {
  for (Location& location : locations) {
    std::vector<std::string>& all = location.estimate.warnings;
    all.insert(all.end(), warnings.begin(), warnings.end());
  }
}

}  // namespace

Expected<std::unique_ptr<PersonEstimator>> PersonEstimator::create(const Site& site,
                                                                   const Options& options) {
  auto room = load_room_model(site);
  RAYLOC_TRY(room);
  auto references = load_references(site, *room);
  RAYLOC_TRY(references);
  return create(
      site, options, std::make_shared<const RoomModel>(*std::move(room)), *std::move(references));
}

Expected<std::unique_ptr<PersonEstimator>> PersonEstimator::create(
    const Site& site,
    const Options& options,
    std::shared_ptr<const RoomModel> room,
    std::vector<PersonReference> references) {
  std::unique_ptr<PersonEstimator> estimator(new PersonEstimator(site, options, std::move(room)));
  const auto training = training_of(site, *options.method, *estimator->room_);
  RAYLOC_TRY(training);
  const auto number_step = static_cast<std::uint64_t>(
      std::count_if(site.transmitters.begin(), site.transmitters.end(), is_fixed));
  for (PersonReference& reference : references) {
    const MacAddress mac = reference.mac;
    const SiteTransmitter* fixed = find_fixed_transmitter(site, mac);
    if (fixed == nullptr) {  // no longer in the site: its bursts are not used
      continue;
    }
    estimator->chains_.add(reference);
    PersonMethodInput input{estimator->room_, std::move(reference), options.settings};
    input.first_number = number_of(*fixed, site);
    input.number_step = number_step;
    input.training = *training;
    if (options.before) {
      go_on(*options.before, mac, input);
    }
    auto method = options.method->create_person(std::move(input));
    RAYLOC_TRY(method);
    estimator->links_.emplace(mac, Link{*std::move(method), number_step, {}});
  }
  return estimator;
}

LocationContext PersonEstimator::context() const {
  LocationContext context;
  context.site = site_.name;
  context.scene_hash = room_->scene_hash;
  context.calibration_id = room_->calibration_id;
  context.method = options_.method->name;
  context.valid_for = options_.valid_for;
  return context;
}

PersonTrackerCounters PersonEstimator::tracker_counters() const {
  const std::lock_guard lock(mutex_);
  return tracker_counters_;
}

void PersonEstimator::publish_counters() {
  PersonTrackerCounters sum;
  for (const auto& [mac, link] : links_) {
    sum += link.method->tracker_counters();
  }
  const std::lock_guard lock(mutex_);
  tracker_counters_ = sum;
}

void PersonEstimator::estimate(const Burst& burst, Estimates& out) {
  const SiteTransmitter* fixed = find_fixed_transmitter(site_, burst.transmitter);
  if (fixed == nullptr || stuck_stamp(burst.frames)) {
    return;
  }
  const std::uint64_t number = number_of(*fixed, site_);
  const auto found = links_.find(burst.transmitter);
  if (found == links_.end()) {
    out.locations.push_back({without_person(burst, kNoReference), person(number), context()});
    return;
  }
  Link& link = found->second;
  const std::size_t first = out.locations.size();
  const PersonChains::Usable usable = chains_.usable(burst, out.chains.get());
  std::vector<LocationEstimate> people;
  std::vector<PersonUpdate> updates;
  if (usable.reason.empty()) {
    people = link.method->locate(usable.frames, 0);
    link.method->track(usable.frames, burst.received_since, updates);
  } else {
    people.push_back(without_person(burst, usable.reason));
  }
  PersonNumbers numbers{number, link.number_step, std::nullopt};
  if (const auto track = link.method->track_number()) {
    numbers.first = *track;
    numbers.tracked = updates.empty() ? std::nullopt : updates.back().estimate.location.position;
  }
  const std::vector<std::uint64_t> each = numbers_of(people, numbers);
  for (std::size_t i = 0; i < people.size(); ++i) {
    out.locations.push_back({std::move(people[i]), person(each[i]), context()});
  }
  append(updates, link, out);
  warn(usable.warnings, std::span(out.locations).subspan(first));
  publish_counters();
}

void PersonEstimator::append(const std::vector<PersonUpdate>& updates,
                             Link& link,
                             Estimates& out) const {
  for (const PersonUpdate& update : updates) {
    const FilteredEstimate& estimate = update.estimate;
    const Target target = person(update.track);
    out.locations.push_back(filtered_location(estimate, target, context()));
    if (estimate.transition) {
      out.events.push_back({target, *estimate.transition, estimate.location.position});
    }
    if (estimate.state == TrackState::kLost) {
      link.lost.emplace_back(estimate.location.time, update.track);
    }
  }
}

void PersonEstimator::advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) {
  for (auto& [mac, link] : links_) {
    if (is_waiting(mac)) {
      continue;
    }
    std::vector<PersonUpdate> updates;
    link.method->advance(time, updates);
    append(updates, link, out);
    std::erase_if(link.lost, [&](const auto& lost) { return lost.first < time; });
  }
  publish_counters();
}

void PersonEstimator::carry(Carried& carried) const {
  for (const auto& [mac, link] : links_) {
    if (const auto number = link.method->track_number()) {
      carried.people.push_back({mac,
                                link.lost.empty() ? *number : link.lost.front().second,
                                link.method->last_moment()});
      carried.received = std::min(carried.received, link.method->seen_until(carried.done));
    }
  }
}

void PersonEstimator::restart(const std::string& reason, Estimates& out) {
  chains_.restart();
  for (auto& [mac, link] : links_) {
    std::vector<PersonUpdate> updates;
    link.method->restart(reason, updates);
    append(updates, link, out);
  }
  publish_counters();
}

}  // namespace rayloc
