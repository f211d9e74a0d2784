// What an experiment found, told three times from one value: for people (a page with its charts),
// for programs (JSON) and for tables (CSV).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/draw/drawing.h"
#include "daemon/experiment/run_experiment.h"
#include "engine/base/expected.h"

namespace rayloc {

// {name, seed, studies: [{name, claim, axes, over, conditions: [{values: {KEY: text},
// statistics}]}]} with the statistics as of `rayloc evaluate --json`.
std::string experiment_json(const Experiment& experiment, const std::vector<StudyResult>& results);

// A row a condition: its study, all keys, the figures. What is infinite or not stated is empty.
std::string experiment_csv(const std::vector<StudyResult>& results);

// A row a point: study, condition and point by number, from 1; the error [m], empty where it was
// missed.
std::string experiment_errors_csv(const std::vector<StudyResult>& results);

// A page that stands alone.
std::string experiment_html(const Experiment& experiment, const std::vector<StudyResult>& results);

// report.html, report.json, report.csv and errors.csv. REQUIRES: the directory exists.
Expected<void> write_experiment_report(const std::filesystem::path& directory,
                                       const Experiment& experiment,
                                       const std::vector<StudyResult>& results);

// Of the median over Study::over, a curve for each combination of the other axes, and with few
// curves their intervals; without numbers to run over, the distributions of the errors.
std::vector<draw::Drawing> draw_study(const StudyResult& result);

}  // namespace rayloc
