// Result of an experiment in three forms from one value: for people (a page with its charts), for
// programs (JSON) and for tables (CSV).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/lab/experiment/run_experiment.h"
#include "daemon/site/plan/drawing.h"
#include "engine/base/expected.h"

namespace rayloc {

// {name, seed, studies: [{name, claim, axes, over, conditions: [{values: {KEY: text},
// statistics}]}]} with the statistics as in `rayloc evaluate --json`.
std::string experiment_json(const Experiment& experiment, const std::vector<StudyResult>& results);

// One row per condition: its study, all keys, the figures. Infinite or absent values are empty.
std::string experiment_csv(const std::vector<StudyResult>& results);

// One row per point: study, condition and point by
// number, from 1; the error [m], empty if it was missed.
std::string experiment_errors_csv(const std::vector<StudyResult>& results);

// A self-contained page.
std::string experiment_html(const Experiment& experiment, const std::vector<StudyResult>& results);

// Writes report.html, report.json, report.csv and errors.csv. REQUIRES: the directory exists.
Expected<void> write_experiment_report(const std::filesystem::path& directory,
                                       const Experiment& experiment,
                                       const std::vector<StudyResult>& results);

// Charts of the median over Study::over, a curve for each combination of the other axes, with
// intervals if there are few curves; without a numeric axis, the distributions of the errors.
std::vector<draw::Drawing> draw_study(const StudyResult& result);

}  // namespace rayloc
