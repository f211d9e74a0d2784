#include "daemon/experiment/run_experiment.h"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "daemon/experiment/study_world.h"
#include "engine/likelihood/likelihood.h"
#include "engine/localize/localizer.h"
#include "engine/paper/paper_localizer.h"
#include "engine/paper/paper_person_localizer.h"
#include "engine/person/calibrate/empty_room.h"
#include "engine/person/person_localizer.h"
#include "engine/room/hear_burst.h"

namespace rayloc {
namespace {

// One method in one room: an estimate for frames and the number of the repeat.
using Locate = std::function<LocationEstimate(const StudySpot& spot, std::size_t repeat)>;

PaperLocalizerOptions options_of(const Condition& condition) {
  PaperLocalizerOptions options = condition.paper_options();
  options.starts = static_cast<std::size_t>(condition.multi_start);
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

Expected<Locate> make_person_method(std::shared_ptr<const RoomModel> room,
                                    const Condition& condition,
                                    const StudyLayout& layout,
                                    std::uint64_t seed) {
  auto reference = refer(*room, layout);
  if (!reference) {
    return tl::make_unexpected(std::move(reference.error()));
  }
  if (condition.method == "paper") {
    auto made = PaperPersonLocalizer::create(std::move(room), *reference, options_of(condition));
    if (!made) {
      return tl::make_unexpected(std::move(made.error()));
    }
    const auto localizer = std::make_shared<const PaperPersonLocalizer>(*std::move(made));
    return [localizer, seed](const StudySpot& spot, std::size_t repeat) {
      return localizer->locate(spot.frames, seed + repeat);
    };
  }
  auto made = PersonLocalizer::create(std::move(room), *std::move(reference), {});
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  const auto localizer = std::make_shared<const PersonLocalizer>(*std::move(made));
  return [localizer](const StudySpot& spot, std::size_t) { return localizer->locate(spot.frames); };
}

Expected<Locate> make_method(const Condition& condition,
                             const StudyLayout& layout,
                             std::uint64_t seed) {
  RoomModel told = layout.model;
  told.trace.max_depth = static_cast<int>(condition.model_depth);
  auto room = std::make_shared<const RoomModel>(std::move(told));
  if (layout.transmitter) {
    return make_person_method(std::move(room), condition, layout, seed);
  }
  if (condition.method == "paper") {
    auto made = PaperLocalizer::create(std::move(room), options_of(condition));
    if (!made) {
      return tl::make_unexpected(std::move(made.error()));
    }
    const auto localizer = std::make_shared<const PaperLocalizer>(*std::move(made));
    return [localizer, seed](const StudySpot& spot, std::size_t repeat) {
      return localizer->locate(spot.frames, seed + repeat);
    };
  }
  LocalizerOptions options;
  options.likelihood = likelihood_of(condition.likelihood);
  auto made = Localizer::create(std::move(room), options);
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  const auto localizer = std::make_shared<const Localizer>(*std::move(made));
  return [localizer](const StudySpot& spot, std::size_t) { return localizer->locate(spot.frames); };
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
