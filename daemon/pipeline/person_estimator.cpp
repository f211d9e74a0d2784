#include "daemon/pipeline/person_estimator.h"

#include "daemon/pipeline/estimates.h"
#include "daemon/site/reference_file.h"
#include "daemon/site/room_model.h"

namespace rayloc {
namespace {

constexpr std::uint64_t kSnapshotTrack = 1;

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
  for (PersonReference& reference : *references) {
    const MacAddress mac = reference.mac;
    auto localizer =
        PersonLocalizer::create(estimator->room_, std::move(reference), options.localizer);
    if (!localizer) {
      return tl::make_unexpected(std::move(localizer.error()));
    }
    auto shared = std::make_shared<const PersonLocalizer>(*std::move(localizer));
    estimator->links_.emplace(mac, Link{shared, PersonTracker(shared, options.tracker)});
  }
  return estimator;
}

LocationContext PersonEstimator::context_of(std::uint64_t track) const {
  LocationContext context;
  context.target.set_kind(v1::TARGET_KIND_PERSON);
  context.target.set_track(track);
  context.frame.set_crs("local");
  context.frame.set_site(site_.name);
  context.frame.set_scene_hash(room_->scene_hash);
  context.frame.set_calibration_id(room_->calibration_id);
  context.method = "rayloc";
  context.valid_for = options_.valid_for;
  return context;
}

void PersonEstimator::estimate(const Burst& burst, Estimates& out) {
  if (find_fixed_transmitter(site_, burst.transmitter) == nullptr) {
    return;
  }
  const auto link = links_.find(burst.transmitter);
  if (link == links_.end()) {
    out.locations.push_back(location_message(without_reference(burst), context_of(kSnapshotTrack)));
    return;
  }
  out.locations.push_back(
      location_message(link->second.localizer->locate(burst.frames), context_of(kSnapshotTrack)));
  std::vector<PersonUpdate> updates;
  link->second.tracker.hear(burst.frames, updates);
  append(updates, out);
}

void PersonEstimator::append(const std::vector<PersonUpdate>& updates, Estimates& out) const {
  for (const PersonUpdate& update : updates) {
    out.locations.push_back(filtered_message(update.estimate, context_of(update.track)));
  }
}

void PersonEstimator::restart(const std::string& reason, Estimates& out) {
  for (auto& [mac, link] : links_) {
    std::vector<PersonUpdate> updates;
    link.tracker.restart(reason, updates);
    append(updates, out);
  }
}

}  // namespace rayloc
