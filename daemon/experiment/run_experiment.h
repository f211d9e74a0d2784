// run_experiment: every condition of every study simulated, located and compared with the truth.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "daemon/evaluate/error_statistics.h"
#include "daemon/evaluate/point_result.h"
#include "daemon/experiment/experiment_file.h"
#include "engine/base/expected.h"

namespace rayloc {

struct ConditionResult {
  Condition condition;
  std::vector<PointResult> points;  // by layout, spot, repeat
  ErrorStatistics statistics;       // spots are drawn for the intervals, with all their repeats
};

struct StudyResult {
  const Study* study = nullptr;
  std::vector<ConditionResult> conditions;  // as in the study
};

using StudyProgress =
    std::function<void(const Study& study, std::size_t done, const ConditionResult& result)>;

// Depends on the experiment alone, whatever the number of threads. Pointers in the result are into
// `experiment`. Errors: as of simulate_world(), or a method that refuses its options.
Expected<std::vector<StudyResult>> run_experiment(const Experiment& experiment,
                                                  const StudyProgress& progress);

}  // namespace rayloc
