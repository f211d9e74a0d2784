// Comparison: estimates of a file beside the surveyed truth, and what it takes nothing, or only the
// survey, to reach.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/evaluate/error_statistics.h"
#include "daemon/evaluate/estimates_file.h"
#include "daemon/evaluate/point_result.h"
#include "daemon/evaluate/truth.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

struct ComparisonRequest {
  std::string estimates;   // file; "-" is standard input
  std::string truth;       // csv
  bool is_person = false;  // else devices
  bool is_filtered = false;
  std::string target = {};                     // only of this one; empty: of all
  Duration time_offset = {};                   // added to the times of the truth
  std::string site = {};                       // for the control by the room's centre; empty: none
  std::vector<std::string> fingerprints = {};  // "[AP=]FILE": with the next two, another control
  std::string points = {};
  std::vector<std::string> captures = {};
};

struct Comparison {
  std::optional<Site> site;
  std::vector<TruthPoint> recorded;              // by the clock of the recordings
  std::vector<TruthPoint> truth;                 // by the clock of the estimates
  std::vector<PublishedEstimate> estimates;      // those asked for
  std::vector<const LocationEstimate*> matches;  // one a point, into `estimates`
  std::vector<PointResult> results;              // one a point
  Controls controls;

  // `matches` point into it.
  Comparison() = default;
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;
  Comparison(Comparison&&) = default;
  Comparison& operator=(Comparison&&) = default;
  ~Comparison() = default;
};

// An Error where a file cannot be read, where no estimate answers for any point, and where what a
// control needs is not all there.
Expected<Comparison> compare_with_truth(const ComparisonRequest& request);

}  // namespace rayloc
