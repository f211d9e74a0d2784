// Comparison: estimates of a file against the surveyed
// truth, and baselines that use nothing, or only the survey.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/evaluate/error_statistics.h"
#include "daemon/lab/evaluate/estimates_file.h"
#include "daemon/lab/evaluate/point_result.h"
#include "daemon/lab/evaluate/truth.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

struct ComparisonRequest {
  std::string estimates;   // file; "-" is standard input
  std::string truth;       // csv
  bool is_person = false;  // else a device
  bool is_filtered = false;
  std::string target = {};                     // only this target; empty: all
  Duration time_offset = {};                   // offset added to the times of the truth
  std::string site = {};                       // for the room-centre control; empty: none
  std::vector<std::string> fingerprints = {};  // "[AP=]FILE": with the next two, a second control
  std::string points = {};
  std::vector<std::string> captures = {};
};

struct Comparison {
  std::optional<Site> site;
  std::vector<TruthPoint> recorded;              // by the clock of the recordings
  std::vector<TruthPoint> truth;                 // by the clock of the estimates
  std::vector<PublishedEstimate> estimates;      // the selected ones
  std::vector<const LocationEstimate*> matches;  // one per point, into `estimates`
  std::vector<PointResult> results;              // one per point
  Controls controls;

  // `matches` point into it.
  Comparison() = default;
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;
  Comparison(Comparison&&) = default;
  Comparison& operator=(Comparison&&) = default;
  ~Comparison() = default;
};

// Returns an Error if a file cannot be read, if no estimate
// matches any point, or if the inputs of a control are incomplete.
// Reports notes on the recordings of the second control to `observer`.
Expected<Comparison> compare_with_truth(const ComparisonRequest& request,
                                        const Observer& observer = {});

}  // namespace rayloc
