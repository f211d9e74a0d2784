#include "daemon/pipeline/person_estimator.h"

#include <algorithm>

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/person_numbers.h"
#include "daemon/site/reference_file.h"
#include "daemon/site/room_model.h"
#include "engine/person/people.h"

namespace rayloc {
namespace {

bool is_fixed(const SiteTransmitter& transmitter) {
  return transmitter.role == TransmitterRole::kFixed;
}

// The place of a fixed transmitter among those of the site, from 1.
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

Target person(std::uint64_t track) { return {TargetKind::kPerson, {}, false, track, {}}; }

// Of a burst that cannot be judged.
LocationEstimate without_reference(const Burst& burst) {
  LocationEstimate estimate;
  estimate.capture_start = burst.first;
  estimate.capture_end = burst.last;
  estimate.time = burst.first + (burst.last - burst.first) / 2;
  estimate.reason =
      "no recording of the empty room with this transmitter: run `rayloc reference` first";
  return estimate;
}

}  // namespace

std::vector<LocationEstimate> PersonEstimator::Link::locate(
    std::span<const CsiFrame> frames) const {
  if (const auto* ours = std::get_if<std::shared_ptr<const PersonLocalizer>>(&localizer)) {
    return locate_people(**ours, frames);
  }
  return {std::get<std::shared_ptr<const PaperPersonLocalizer>>(localizer)->locate(frames)};
}

Expected<PersonEstimator::Link> PersonEstimator::prepare(
    PersonReference reference, const PersonTrackerOptions& tracker) const {
  if (options_.method == LocationMethod::kPaper) {
    auto made = PaperPersonLocalizer::create(room_, reference, options_.paper);
    if (!made) {
      return tl::make_unexpected(std::move(made.error()));
    }
    return Link{std::make_shared<const PaperPersonLocalizer>(*std::move(made)),
                std::nullopt,
                tracker.number_step};
  }
  auto made = PersonLocalizer::create(room_, std::move(reference), options_.localizer);
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  const auto shared = std::make_shared<const PersonLocalizer>(*std::move(made));
  return Link{shared, PersonTracker(shared, tracker), tracker.number_step};
}

Expected<std::unique_ptr<PersonEstimator>> PersonEstimator::create(const Site& site,
                                                                   const Options& options) {
  std::unique_ptr<PersonEstimator> estimator(new PersonEstimator(site, options));
  auto room = load_room_model(site);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  estimator->room_ = std::make_shared<const RoomModel>(*std::move(room));
  auto references = load_references(site, *estimator->room_);
  if (!references) {
    return tl::make_unexpected(std::move(references.error()));
  }
  PersonTrackerOptions tracker = options.tracker;
  tracker.number_step = static_cast<std::uint64_t>(
      std::count_if(site.transmitters.begin(), site.transmitters.end(), is_fixed));
  for (PersonReference& reference : *references) {
    const MacAddress mac = reference.mac;
    const SiteTransmitter* fixed = find_fixed_transmitter(site, mac);
    if (fixed == nullptr) {  // no longer: nobody listens to it
      continue;
    }
    tracker.first_number = number_of(*fixed, site);
    auto link = estimator->prepare(std::move(reference), tracker);
    if (!link) {
      return tl::make_unexpected(std::move(link.error()));
    }
    estimator->links_.emplace(mac, *std::move(link));
  }
  return estimator;
}

LocationContext PersonEstimator::context() const {
  LocationContext context;
  context.site = site_.name;
  context.scene_hash = room_->scene_hash;
  context.calibration_id = room_->calibration_id;
  context.method = method_name(options_.method);
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
    if (link.tracker) {
      sum += link.tracker->counters();
    }
  }
  const std::lock_guard lock(mutex_);
  tracker_counters_ = sum;
}

void PersonEstimator::estimate(const Burst& burst, Estimates& out) {
  const SiteTransmitter* fixed = find_fixed_transmitter(site_, burst.transmitter);
  if (fixed == nullptr) {
    return;
  }
  const std::uint64_t number = number_of(*fixed, site_);
  const auto found = links_.find(burst.transmitter);
  if (found == links_.end()) {
    out.locations.push_back({without_reference(burst), person(number), context()});
    return;
  }
  Link& link = found->second;
  std::vector<LocationEstimate> people = link.locate(burst.frames);
  std::vector<PersonUpdate> updates;
  PersonNumbers numbers{number, link.number_step, std::nullopt};
  if (link.tracker) {
    link.tracker->hear(burst.frames, updates, burst.heard_since);
    numbers.first = link.tracker->number();
    numbers.tracked = updates.empty() ? std::nullopt : updates.back().estimate.location.position;
  }
  const std::vector<std::uint64_t> each = numbers_of(people, numbers);
  for (std::size_t i = 0; i < people.size(); ++i) {
    out.locations.push_back({std::move(people[i]), person(each[i]), context()});
  }
  append(updates, out);
  publish_counters();
}

void PersonEstimator::append(const std::vector<PersonUpdate>& updates, Estimates& out) const {
  for (const PersonUpdate& update : updates) {
    const FilteredEstimate& estimate = update.estimate;
    const Target target = person(update.track);
    out.locations.push_back(filtered_location(estimate, target, context()));
    if (estimate.transition) {
      out.events.push_back({target, *estimate.transition, estimate.location.position});
    }
  }
}

void PersonEstimator::advance(Timestamp time, Estimates& out) {
  for (auto& [mac, link] : links_) {
    if (!link.tracker) {
      continue;
    }
    std::vector<PersonUpdate> updates;
    link.tracker->advance(time, updates);
    append(updates, out);
  }
  publish_counters();
}

void PersonEstimator::restart(const std::string& reason, Estimates& out) {
  for (auto& [mac, link] : links_) {
    if (!link.tracker) {
      continue;
    }
    std::vector<PersonUpdate> updates;
    link.tracker->restart(reason, updates);
    append(updates, out);
  }
  publish_counters();
}

}  // namespace rayloc
