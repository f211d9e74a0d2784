#include "daemon/lab/experiment/study_method.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method_registry.h"
#include "daemon/methods/person_method.h"
#include "daemon/pipeline/burst_collector.h"
#include "engine/baselines/settings.h"
#include "engine/baselines/training.h"
#include "engine/person/calibrate/empty_room.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

// Options of the method, from the condition's keys.
MethodOptions options_of(const Condition& condition, const Method& method, std::uint64_t seed) {
  MethodValues all = {{"likelihood", condition.likelihood}, {"multi_start", condition.multi_start}};
  for (const auto& [key, value] : condition.paper) {
    all.emplace(key, value);
  }
  if (condition.epochs > 0.0) {
    all.emplace("epochs", condition.epochs);
  }
  std::erase_if(all, [&](const auto& entry) { return !method.has_setting(entry.first); });
  MethodOptions options;
  options.seed = seed;
  options.values = std::move(all);
  return options;
}

// Fits the reference of the empty room; the person's radius is the model's (METHODS B5).
Expected<PersonReference> refer(const RoomModel& room, const StudyLayout& layout) {
  std::vector<EmptyRoom> empty;
  std::vector<std::string> warnings;
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    auto burst = preprocess_burst(room, ap, layout.empty, {}, warnings);
    if (burst) {
      empty.push_back({ap, std::move(burst->h)});
    }
  }
  if (empty.empty()) {
    return bad_input("no access point receives the fixed transmitter of the empty room");
  }
  auto reference = fit_empty_room(room, *layout.transmitter, empty);
  RAYLOC_TRY(reference);
  reference->mac = kStudyTransmitter;
  return reference;
}

// Trains the method on the layout's survey; null: it needs no training.
Expected<std::shared_ptr<const Training>> learn(const Condition& condition,
                                                const Method& method,
                                                const std::shared_ptr<const RoomModel>& room,
                                                const MethodOptions& options,
                                                const StudyLayout& layout) {
  if (method.train == nullptr || layout.survey.empty()) {
    if (method.needs_training) {
      return make_error(ErrorKind::kConfiguration, "no survey: survey_points is 0");
    }
    return nullptr;
  }
  TrainingInput input;
  input.room = room;
  input.seed = options.seed;
  for (const auto& [key, value] : options.values) {
    const auto& known = method.baseline_settings;
    if (std::any_of(known.begin(), known.end(), [&, &wanted = key](const auto& one) {
          return one.key == wanted;
        })) {
      input.values.insert_or_assign(key, value);
    }
  }
  for (const StudyPoint& point : layout.survey) {
    input.points.push_back({point.position, point.frames});
  }
  if (layout.transmitter) {
    input.transmitter = kStudyTransmitter;
    input.empty = layout.empty;
  }
  if (condition.constant_power > 0.0) {
    input.constant_power.push_back(kStudyTransmitter);
  }
  return method.train(input);
}

bool has_frames(const StudyLayout& layout) {
  const auto has = [](const auto& one) { return !one.frames.empty(); };
  return std::any_of(layout.test_points.begin(), layout.test_points.end(), has) ||
         std::any_of(layout.walks.begin(), layout.walks.end(), has);
}

tl::unexpected<Error> no_frames() {
  return make_error(ErrorKind::kConfiguration, "no frame is of the plan's channel");
}

// The room model given to the method.
std::shared_ptr<const RoomModel> model_room(const Condition& condition, const StudyLayout& layout) {
  RoomModel model = layout.model;
  model.trace.max_depth = static_cast<int>(condition.model_depth);
  if (condition.chains == "first_day") {
    for (std::size_t ap = 0; ap < model.access_points.size(); ++ap) {
      model.access_points[ap].gains = layout.first_day_chains[ap];
    }
  }
  return std::make_shared<const RoomModel>(std::move(model));
}

// Makes a person method from all its inputs but the start.
struct PeopleMaker {
  const Method* method = nullptr;
  std::shared_ptr<const RoomModel> room;
  PersonReference reference;
  MethodOptions options;
  std::shared_ptr<const Training> training;

  Expected<std::unique_ptr<PersonMethod>> make(std::optional<Vec3d> start) const {
    PersonMethodInput input{room, reference, options};
    input.options.start = start;
    input.training = training;
    return method->create_person(std::move(input));
  }
};

Expected<PeopleMaker> prepare_people(const Condition& condition,
                                     const StudyLayout& layout,
                                     std::uint64_t seed) {
  const Method& method = *find_method(condition.method);
  PeopleMaker maker;
  maker.method = &method;
  maker.room = model_room(condition, layout);
  maker.options = options_of(condition, method, seed);
  auto training = learn(condition, method, maker.room, maker.options, layout);
  RAYLOC_TRY(training);
  maker.training = *std::move(training);
  auto reference = refer(*maker.room, layout);
  RAYLOC_TRY(reference);
  maker.reference = *std::move(reference);
  return maker;
}

Expected<Locate> locate_people(const Condition& condition,
                               const StudyLayout& layout,
                               std::uint64_t seed) {
  const auto maker = prepare_people(condition, layout, seed);
  RAYLOC_TRY(maker);
  auto made = maker->make(std::nullopt);
  RAYLOC_TRY(made);
  const std::shared_ptr<const PersonMethod> people = *std::move(made);
  return [people](const StudyPoint& test_point, std::size_t repeat) {
    return people->locate(test_point.frames, repeat).front();
  };
}

// The bursts that `rayloc replay` would pass to the method.
std::vector<Burst> bursts_of(const StudyWalk& walk, const CollectorOptions& options) {
  BurstCollector collector(options);
  std::vector<Burst> bursts;
  for (const CsiFrame& frame : walk.frames) {
    collector.add(CsiFrame(frame), bursts);
  }
  if (!walk.frames.empty()) {
    collector.advance(walk.frames.back().time + options.length + options.gap, bursts);
  }
  return bursts;
}

PublishedEstimate published(LocationEstimate estimate, bool filtered) {
  return {true, filtered, "person-1", std::move(estimate)};
}

// The track of a method that has tracks; for other methods,
// or without any track, an estimate of each burst.
std::vector<PublishedEstimate> follow_by_method(PersonMethod& method,
                                                const Method& row,
                                                const StudyWalk& walk) {
  CollectorOptions options;
  if (row.needs_every_frame) {
    options.max_frames = walk.frames.size();
  }
  const std::vector<Burst> bursts = bursts_of(walk, options);
  std::vector<PublishedEstimate> estimates;
  if (method.track_number()) {
    std::vector<PersonUpdate> updates;
    method.restart("another walk", updates);
    updates.clear();  // end of the previous walk
    for (const Burst& burst : bursts) {
      method.track(burst.frames, burst.received_since, updates);
      method.advance(burst.last, updates);
    }
    for (PersonUpdate& update : updates) {
      estimates.push_back(published(std::move(update.estimate.location), true));
    }
    if (!estimates.empty()) {
      return estimates;
    }
  }
  for (const Burst& burst : bursts) {
    for (LocationEstimate& estimate : method.locate(burst.frames, 0)) {
      if (method.track_number()) {  // its reason why there is no track
        estimate.position.reset();
      }
      estimates.push_back(published(std::move(estimate), false));
    }
  }
  return estimates;
}

// Locates each burst alone; the position of its test point is the start of the walk.
std::vector<PublishedEstimate> follow_by_bursts(const Locate& locate, const StudyWalk& walk) {
  std::vector<PublishedEstimate> estimates;
  for (Burst& burst : bursts_of(walk, {})) {
    LocationEstimate estimate = locate({walk.truth.front().position, std::move(burst.frames)}, 0);
    estimate.time = burst.first + (burst.last - burst.first) / 2;
    estimates.push_back(published(std::move(estimate), false));
  }
  return estimates;
}

// match() takes estimates at most 0.06 s from an instant, and a burst lasts 0.2 s: the estimate of
// a burst is also used at 0.05 s before and after its middle.
std::vector<PublishedEstimate> held(std::vector<PublishedEstimate> estimates) {
  constexpr Duration kStep = std::chrono::milliseconds(50);
  std::vector<PublishedEstimate> all;
  for (PublishedEstimate& one : estimates) {
    for (const int steps : {-1, 0, 1}) {
      all.push_back(one);
      all.back().estimate.time += steps * kStep;
    }
  }
  return all;
}

}  // namespace

Expected<Locate> make_locate(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed) {
  if (!has_frames(layout)) {
    return no_frames();
  }
  if (is_control(condition)) {
    return make_control(condition.method,
                        model_room(condition, layout),
                        layout,
                        condition.constant_power > 0.0,
                        seed);
  }
  const Method& method = *find_method(condition.method);
  if (layout.transmitter) {
    if (method.needs_every_frame) {
      return make_error(
          ErrorKind::kConfiguration,
          std::string(method.name) + " tracks people who walk; here people are at rest");
    }
    return locate_people(condition, layout, seed);
  }
  DeviceMethodInput input{model_room(condition, layout), options_of(condition, method, seed)};
  auto training = learn(condition, method, input.room, input.options, layout);
  RAYLOC_TRY(training);
  input.training = *std::move(training);
  auto made = method.create_device(std::move(input));
  RAYLOC_TRY(made);
  const std::shared_ptr<const DeviceMethod> devices = *std::move(made);
  return [devices](const StudyPoint& test_point, std::size_t repeat) {
    return devices->locate(test_point.frames, repeat);
  };
}

Expected<Follow> make_follow(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed) {
  if (is_control(condition)) {
    auto locate = make_locate(condition, layout, seed);
    RAYLOC_TRY(locate);
    return [locate = *std::move(locate)](const StudyWalk& walk) {
      return held(follow_by_bursts(locate, walk));
    };
  }
  if (!has_frames(layout)) {
    return no_frames();
  }
  auto prepared = prepare_people(condition, layout, seed);
  RAYLOC_TRY(prepared);
  const auto maker = std::make_shared<const PeopleMaker>(*std::move(prepared));
  // Created once, or once per walk if the method takes its start.
  auto made = std::make_shared<std::unique_ptr<PersonMethod>>();
  return [maker, made](const StudyWalk& walk) -> Expected<std::vector<PublishedEstimate>> {
    const Method& row = *maker->method;
    const bool begins_at_start = row.takes_start && row.needs_every_frame;
    if (*made == nullptr || begins_at_start) {
      auto method =
          maker->make(begins_at_start ? std::optional(walk.truth.front().position) : std::nullopt);
      RAYLOC_TRY(method);
      *made = *std::move(method);
    }
    std::vector<PublishedEstimate> estimates = follow_by_method(**made, row, walk);
    const bool is_filtered = !estimates.empty() && estimates.front().filtered;
    return is_filtered ? std::move(estimates) : held(std::move(estimates));
  };
}

}  // namespace rayloc
