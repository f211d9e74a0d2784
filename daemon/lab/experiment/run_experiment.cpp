#include "daemon/lab/experiment/run_experiment.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/lab/evaluate/truth.h"
#include "daemon/lab/experiment/study_method.h"
#include "daemon/lab/experiment/study_world.h"
#include "daemon/methods/method_registry.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {
namespace {

// The layout without the frames of other channels than the plan's, which a receiver rejects for a
// method that does not use them; empty if the method takes all frames.
std::optional<StudyLayout> own_channel(const Condition& condition, const StudyLayout& layout) {
  const Method* method = find_method(condition.method);
  if (condition.channels == "plan" || (method != nullptr && method->uses_every_channel)) {
    return std::nullopt;
  }
  StudyLayout own = layout;
  const OfdmGrid& grid = layout.model.grid;
  own.empty = frames_on(grid, own.empty);
  for (std::vector<StudyPoint>* test_points : {&own.test_points, &own.survey}) {
    for (StudyPoint& test_point : *test_points) {
      test_point.frames = frames_on(grid, test_point.frames);
    }
  }
  for (StudyWalk& walk : own.walks) {
    walk.frames = frames_on(grid, walk.frames);
  }
  return own;
}

// The reason why no test point was located, if it is the same for all.
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

Vec3d centre_of(const StudyLayout& layout) {
  return 0.5 * (layout.model.bounds_min + layout.model.bounds_max);
}

void locate_test_points(const StudyLayout& layout,
                        std::uint64_t seed,
                        ConditionResult& result,
                        CommonReason& reasons) {
  const auto locate = make_locate(result.condition, layout, seed);
  if (!locate) {
    result.refusal = locate.error().message;
  }
  for (const StudyPoint& test_point : layout.test_points) {
    TruthPoint truth;
    truth.position = test_point.position;
    for (std::size_t repeat = 0; repeat < static_cast<std::size_t>(result.condition.repeats);
         ++repeat) {
      if (locate) {
        const LocationEstimate estimate = (*locate)(test_point, repeat);
        result.points.push_back(evaluate_point(truth, &estimate));
        reasons.add(estimate);
      } else {
        result.points.push_back(evaluate_point(truth, nullptr));
      }
      result.room_centre.push_back(horizontal_distance(centre_of(layout), test_point.position));
    }
  }
}

void follow_walks(const StudyLayout& layout,
                  std::uint64_t seed,
                  ConditionResult& result,
                  CommonReason& reasons) {
  const auto follow = make_follow(result.condition, layout, seed);
  if (!follow) {
    result.refusal = follow.error().message;
  }
  for (const StudyWalk& walk : layout.walks) {
    std::vector<PublishedEstimate> estimates;
    if (follow) {
      auto followed = (*follow)(walk);
      if (followed) {
        estimates = *std::move(followed);
      } else {
        result.refusal = followed.error().message;
      }
    }
    for (const PublishedEstimate& one : estimates) {
      reasons.add(one.estimate);
    }
    const std::vector<const LocationEstimate*> answers = match(walk.truth, estimates);
    for (std::size_t i = 0; i < walk.truth.size(); ++i) {
      result.points.push_back(evaluate_point(walk.truth[i], answers[i]));
      result.room_centre.push_back(horizontal_distance(centre_of(layout), walk.truth[i].position));
    }
  }
}

ConditionResult run_condition(const Condition& condition,
                              const std::vector<StudyLayout>& layouts,
                              std::uint64_t seed) {
  ConditionResult result;
  result.condition = condition;
  CommonReason reasons;
  for (const StudyLayout& simulated : layouts) {
    const std::optional<StudyLayout> own = own_channel(condition, simulated);
    const StudyLayout& layout = own ? *own : simulated;
    if (is_walking(condition)) {
      follow_walks(layout, seed, result, reasons);
    } else {
      locate_test_points(layout, seed, result, reasons);
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
  const Condition& condition = result.condition;
  options.together = is_walking(condition)
                         ? result.points.size() /
                               static_cast<std::size_t>(condition.layouts * condition.test_points)
                         : static_cast<std::size_t>(condition.repeats);
  result.statistics = compute_statistics(result.points, {result.room_centre, {}}, options);
}

// The layouts of the last world: conditions that
// differ only in the method follow one another.
class Worlds {
 public:
  Expected<const std::vector<StudyLayout>*> get(const Condition& condition, std::uint64_t seed) {
    std::string text = world_text(condition);
    if (layouts_.empty() || text != text_) {
      auto simulated = simulate_world(condition, seed);
      RAYLOC_TRY(simulated);
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
      RAYLOC_TRY(layouts);
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
