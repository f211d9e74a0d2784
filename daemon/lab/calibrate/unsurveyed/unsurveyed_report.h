// Report of a calibration without a survey that keeps the walls of the plan: a verdict in one
// sentence, the most useful next steps, and the chains that were learned.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/lab/calibrate/calibrate_rechain.h"

namespace rayloc {

struct UnsurveyedReport {
  std::string site;
  std::string calibration_id;
  std::vector<std::string> access_points;  // all of the site
  std::optional<RechainResult> chains;     // empty: nothing was recorded
  std::size_t bursts = 0;                  // that were located with these chains
  std::size_t places = 0;                  // bursts with a reliable position
  std::size_t needed = 0;                  // places that a fit of the walls needs
  std::vector<std::string> reasons;        // against a fit of the walls; empty: there was none
};

// States an accuracy only where engine/studies/2026-11-unsurveyed.md has measured it.
std::string expectation(const UnsurveyedReport& report);

// Next steps, most useful first.
std::vector<std::string> advice(const UnsurveyedReport& report);

// Keys as in daemon/lab/calibrate/REPORT.md.
nlohmann::ordered_json to_json(const UnsurveyedReport& report);

// One page without script or pictures; well-formed XML.
std::string to_html(const UnsurveyedReport& report);

}  // namespace rayloc
