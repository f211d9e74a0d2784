#include "daemon/experiment/run_experiment.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "daemon/experiment/study_world.h"
#include "daemon/methods/device_method.h"
#include "daemon/methods/method_registry.h"
#include "daemon/methods/person_method.h"
#include "engine/person/calibrate/empty_room.h"
#include "engine/room/hear_burst.h"

namespace rayloc {
namespace {

// One method in one room: an estimate for frames and the number of the repeat.
using Locate = std::function<LocationEstimate(const StudySpot& spot, std::size_t repeat)>;

// What the condition says to its method.
MethodOptions options_of(const Condition& condition, const Method& method, std::uint64_t seed) {
  MethodValues all = {{"likelihood", condition.likelihood}, {"multi_start", condition.multi_start}};
  for (const auto& [key, value] : condition.paper) {
    all.emplace(key, value);
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

Expected<Locate> locate_people_by(const Method& method,
                                  std::shared_ptr<const RoomModel> room,
                                  MethodOptions options,
                                  const StudyLayout& layout) {
  auto reference = refer(*room, layout);
  if (!reference) {
    return tl::make_unexpected(std::move(reference.error()));
  }
  auto made = method.create_person({std::move(room), *std::move(reference), std::move(options)});
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
  const Method& method = *find_method(condition.method);
  RoomModel told = layout.model;
  told.trace.max_depth = static_cast<int>(condition.model_depth);
  if (condition.chains == "first_day") {
    for (std::size_t ap = 0; ap < told.access_points.size(); ++ap) {
      told.access_points[ap].gains = layout.first_day_chains[ap];
    }
  }
  auto room = std::make_shared<const RoomModel>(std::move(told));
  MethodOptions options = options_of(condition, method, seed);
  if (layout.transmitter) {
    return locate_people_by(method, std::move(room), std::move(options), layout);
  }
  auto made = method.create_device({std::move(room), std::move(options)});
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  const std::shared_ptr<const DeviceMethod> devices = *std::move(made);
  return [devices](const StudySpot& spot, std::size_t repeat) {
    return devices->locate(spot.frames, repeat);
  };
}

Expected<ConditionResult> run_condition(const Condition& condition,
                                        const std::vector<StudyLayout>& layouts,
                                        std::uint64_t seed) {
  ConditionResult result;
  result.condition = condition;
  Controls controls;
  const auto repeats = static_cast<std::size_t>(condition.repeats);
  for (const StudyLayout& layout : layouts) {
    const auto locate = make_method(condition, layout, seed);
    if (!locate) {
      return tl::make_unexpected(locate.error());
    }
    const Vec3d centre = 0.5 * (layout.model.bounds_min + layout.model.bounds_max);
    for (const StudySpot& spot : layout.spots) {
      TruthPoint truth;
      truth.position = spot.position;
      for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
        const LocationEstimate estimate = (*locate)(spot, repeat);
        result.points.push_back(evaluate_point(truth, &estimate));
        controls.room_centre.push_back(horizontal_distance(centre, spot.position));
      }
    }
  }
  BootstrapOptions options;
  options.seed = seed;
  options.together = repeats;
  result.statistics = compute_statistics(result.points, controls, options);
  return result;
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
                                                  const StudyProgress& progress) {
  std::vector<StudyResult> results;
  Worlds worlds;
  for (const Study& study : experiment.studies) {
    StudyResult& result = results.emplace_back();
    result.study = &study;
    for (const Condition& condition : study.conditions) {
      const auto layouts = worlds.get(condition, experiment.seed);
      if (!layouts) {
        return tl::make_unexpected(layouts.error());
      }
      auto done = run_condition(condition, **layouts, experiment.seed);
      if (!done) {
        return make_error(done.error().kind, "study '" + study.name + "': " + done.error().message);
      }
      result.conditions.push_back(*std::move(done));
      progress(study, result.conditions.size(), result.conditions.back());
    }
  }
  return results;
}

}  // namespace rayloc
