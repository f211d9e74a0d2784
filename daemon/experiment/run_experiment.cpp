#include "daemon/experiment/run_experiment.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/experiment/controls.h"
#include "daemon/experiment/study_world.h"
#include "daemon/methods/device_method.h"
#include "daemon/methods/method_registry.h"
#include "daemon/methods/person_method.h"
#include "engine/baselines/settings.h"
#include "engine/baselines/training.h"
#include "engine/person/calibrate/empty_room.h"
#include "engine/room/hear_burst.h"

namespace rayloc {
namespace {

// What the condition says to its method.
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

// A person of whom the radius is believed and the empty room was heard (METHODS B5).
Expected<PersonReference> refer(const RoomModel& room, const StudyLayout& layout) {
  std::vector<EmptyRoom> empty;
  std::vector<std::string> warnings;
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    auto burst = hear(room, ap, layout.empty, {}, warnings);
    if (burst) {
      empty.push_back({ap, std::move(burst->h)});
    }
  }
  if (empty.empty()) {
    return bad_input("no access point hears the fixed transmitter of the empty room");
  }
  auto reference = fit_empty_room(room, *layout.transmitter, empty);
  if (!reference) {
    return tl::make_unexpected(std::move(reference.error()));
  }
  reference->mac = kStudyTransmitter;
  return reference;
}

// What the method learns of the layout's survey; null: nothing.
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
  for (const StudySpot& point : layout.survey) {
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

Expected<Locate> locate_people_by(const Method& method,
                                  std::shared_ptr<const RoomModel> room,
                                  MethodOptions options,
                                  std::shared_ptr<const Training> training,
                                  const StudyLayout& layout) {
  if (method.needs_every_frame) {
    return make_error(ErrorKind::kConfiguration,
                      std::string(method.name) + " follows who walks; here people stand");
  }
  auto reference = refer(*room, layout);
  if (!reference) {
    return tl::make_unexpected(std::move(reference.error()));
  }
  PersonMethodInput input{std::move(room), *std::move(reference), std::move(options)};
  input.training = std::move(training);
  auto made = method.create_person(std::move(input));
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  const std::shared_ptr<const PersonMethod> people = *std::move(made);
  return [people](const StudySpot& spot, std::size_t repeat) {
    return people->locate(spot.frames, repeat).front();
  };
}

Expected<Locate> make_method(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed) {
  RoomModel told = layout.model;
  told.trace.max_depth = static_cast<int>(condition.model_depth);
  if (condition.chains == "first_day") {
    for (std::size_t ap = 0; ap < told.access_points.size(); ++ap) {
      told.access_points[ap].gains = layout.first_day_chains[ap];
    }
  }
  auto room = std::make_shared<const RoomModel>(std::move(told));
  if (is_control(condition)) {
    return make_control(
        condition.method, std::move(room), layout, condition.constant_power > 0.0, seed);
  }
  const Method& method = *find_method(condition.method);
  MethodOptions options = options_of(condition, method, seed);
  auto training = learn(condition, method, room, options, layout);
  if (!training) {
    return tl::make_unexpected(std::move(training.error()));
  }
  if (layout.transmitter) {
    return locate_people_by(
        method, std::move(room), std::move(options), *std::move(training), layout);
  }
  DeviceMethodInput input{std::move(room), std::move(options)};
  input.training = *std::move(training);
  auto made = method.create_device(std::move(input));
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  const std::shared_ptr<const DeviceMethod> devices = *std::move(made);
  return [devices](const StudySpot& spot, std::size_t repeat) {
    return devices->locate(spot.frames, repeat);
  };
}

// Why no spot was located, where all say the same.
class CommonReason {
 public:
  void add(const LocationEstimate& estimate) {
    is_common_ = is_common_ && !estimate.position && (text_.empty() || text_ == estimate.reason);
    text_ = estimate.reason;
  }
  std::string text() const { return is_common_ ? text_ : std::string(); }

 private:
  bool is_common_ = true;
  std::string text_;
};

ConditionResult run_condition(const Condition& condition,
                              const std::vector<StudyLayout>& layouts,
                              std::uint64_t seed) {
  ConditionResult result;
  result.condition = condition;
  CommonReason reasons;
  const auto repeats = static_cast<std::size_t>(condition.repeats);
  for (const StudyLayout& layout : layouts) {
    const auto locate = make_method(condition, layout, seed);
    if (!locate) {
      result.refusal = locate.error().message;
    }
    const Vec3d centre = 0.5 * (layout.model.bounds_min + layout.model.bounds_max);
    for (const StudySpot& spot : layout.spots) {
      TruthPoint truth;
      truth.position = spot.position;
      for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
        if (locate) {
          const LocationEstimate estimate = (*locate)(spot, repeat);
          result.points.push_back(evaluate_point(truth, &estimate));
          reasons.add(estimate);
        } else {
          result.points.push_back(evaluate_point(truth, nullptr));
        }
        result.room_centre.push_back(horizontal_distance(centre, spot.position));
      }
    }
  }
  if (result.refusal.empty()) {
    result.refusal = reasons.text();
  }
  return result;
}

void summarise(ConditionResult& result, std::uint64_t seed) {
  BootstrapOptions options;
  options.seed = seed;
  options.together = static_cast<std::size_t>(result.condition.repeats);
  result.statistics = compute_statistics(result.points, {result.room_centre, {}}, options);
}

// The layouts of the last world: conditions that differ only in how they locate come one after the
// other.
class Worlds {
 public:
  Expected<const std::vector<StudyLayout>*> get(const Condition& condition, std::uint64_t seed) {
    std::string text = world_text(condition);
    if (layouts_.empty() || text != text_) {
      auto simulated = simulate_world(condition, seed);
      if (!simulated) {
        return tl::make_unexpected(std::move(simulated.error()));
      }
      layouts_ = *std::move(simulated);
      text_ = std::move(text);
    }
    return &layouts_;
  }

 private:
  std::string text_;
  std::vector<StudyLayout> layouts_;
};

}  // namespace

Expected<std::vector<StudyResult>> run_experiment(const Experiment& experiment,
                                                  const StudyProgress& progress,
                                                  const ConditionStore& store) {
  std::vector<StudyResult> results;
  Worlds worlds;
  for (const Study& study : experiment.studies) {
    StudyResult& result = results.emplace_back();
    result.study = &study;
    for (const Condition& condition : study.conditions) {
      const std::optional<ConditionResult> kept =
          store.load ? store.load(condition, experiment.seed) : std::nullopt;
      if (kept) {
        result.conditions.push_back(*kept);
        summarise(result.conditions.back(), experiment.seed);
        progress(study, result.conditions.size(), result.conditions.back());
        continue;
      }
      const auto layouts = worlds.get(condition, experiment.seed);
      if (!layouts) {
        return tl::make_unexpected(layouts.error());
      }
      result.conditions.push_back(run_condition(condition, **layouts, experiment.seed));
      summarise(result.conditions.back(), experiment.seed);
      if (store.save) {
        store.save(result.conditions.back(), experiment.seed);
      }
      progress(study, result.conditions.size(), result.conditions.back());
    }
  }
  return results;
}

}  // namespace rayloc
