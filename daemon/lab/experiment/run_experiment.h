// run_experiment: simulates and locates every condition of every study, compared with the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/lab/evaluate/error_statistics.h"
#include "daemon/lab/evaluate/point_result.h"
#include "daemon/lab/experiment/experiment_file.h"
#include "engine/base/expected.h"

namespace rayloc {

struct ConditionResult {
  Condition condition;
  std::vector<PointResult> points;  // by layout, point, repeat; for walks by layout, walk, instant
  // Intervals resample test points with all their repeats, and walks with all their instants.
  ErrorStatistics statistics;
  // Reason why the method, outside its domain, gives no location; empty: it is in its domain.
  std::string refusal = {};
  std::vector<double> room_centre = {};  // [m], error of answering the room's centre, by point
};

struct StudyResult {
  const Study* study = nullptr;
  std::vector<ConditionResult> conditions;  // as in the study
};

using StudyProgress =
    std::function<void(const Study& study, std::size_t done, const ConditionResult& result)>;

// Keeps results, so that an interrupted run resumes. Both may be empty.
struct ConditionStore {
  std::function<std::optional<ConditionResult>(const Condition&, std::uint64_t seed)> load;
  std::function<void(const ConditionResult&, std::uint64_t seed)> save;
};

// The result depends on the experiment alone, whatever the number of threads. Pointers in the
// result are into `experiment`. Errors: as in simulate_world(). A method that refuses is a result.
Expected<std::vector<StudyResult>> run_experiment(const Experiment& experiment,
                                                  const StudyProgress& progress,
                                                  const ConditionStore& store = {});

}  // namespace rayloc
