#include "daemon/lab/calibrate/unsurveyed/unsurveyed_report.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/lab/calibrate/report/introduction.h"
#include "daemon/lab/draw/html.h"

namespace rayloc {
namespace {

using draw::html_paragraph;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMeasuredWith = 3;  // access points of the rooms of the study

std::size_t known_of(const UnsurveyedReport& report) {
  return report.chains ? report.chains->access_points.size() : 0;
}

// Tables "Live, from the plan alone" and "The same, and chains are learned on the way" of
// engine/studies/2026-11-unsurveyed.md, and its sentence on one access point.
std::string plan_accuracy(std::size_t access_points) {
  if (access_points >= kMeasuredWith) {
    return "expect 0.5 to 0.9 m until raylocd has learned the receive chains from moving devices, "
           "and then about 0.1 m in a room, or 0.7 m in a corridor of 31 m (medians with 3 access "
           "points)";
  }
  if (access_points == 1) {
    return "with one access point a position is rare (17 of 100 places in two rooms had one) until "
           "raylocd has learned the receive chains from moving devices; the accuracy afterwards "
           "was not measured";
  }
  return fmt::format(
      "positions are coarse until raylocd has learned the receive chains from moving devices; the "
      "accuracy with {} access points was not measured",
      access_points);
}

// Rows "chains alone", "heard alone" and "lived in" of the same study.
std::string chains_accuracy(std::size_t known) {
  if (known >= kMeasuredWith) {
    return "expect 0.06 to 0.11 m (medians in two meeting rooms with 3 access points)";
  }
  if (known == 1) {
    return "expect 0.8 to 1.6 m in a room, or 9.0 m in a corridor, where 19 of 50 places had no "
           "position (medians with one access point), and chains that may be wrong although they "
           "fit";
  }
  return fmt::format("the accuracy with {} access points was not measured", known);
}

std::vector<RefusedInput> refused_of(const UnsurveyedReport& report) {
  return report.chains ? report.chains->refused : std::vector<RefusedInput>();
}

Json chains_json(const UnsurveyedReport& report) {
  Json all = Json::array();
  if (report.chains) {
    for (const RechainedAccessPoint& one : report.chains->access_points) {
      all.push_back({{"id", one.id}, {"learned_from_bursts", one.learned_from}});
    }
  }
  return all;
}

std::string chain_table(const UnsurveyedReport& report) {
  draw::HtmlTable table{{"access point", "receive chains"}, {}};
  for (const std::string& id : report.access_points) {
    std::string state = "unknown: raylocd learns them from moving devices";
    for (const RefusedInput& one : refused_of(report)) {
      state = one.what == id ? "unknown: " + one.reason : state;
    }
    if (report.chains) {
      for (const RechainedAccessPoint& one : report.chains->access_points) {
        state = one.id == id ? fmt::format("learned from {} bursts of devices", one.learned_from)
                             : state;
      }
    }
    table.rows.push_back({id, state});
  }
  return to_html(table);
}

std::string walls_text(const UnsurveyedReport& report) {
  if (!report.chains) {
    return html_paragraph(
        "Nothing was recorded: walls, antennas and materials are those of the plan.");
  }
  std::string html = html_paragraph(fmt::format(
      "Walls, antennas and materials are those of the plan. {} of {} bursts of devices have a "
      "reliable position; a fit of the walls needs {}.",
      report.places,
      report.bursts,
      report.needed));
  if (!report.reasons.empty()) {
    html += html_paragraph(
        "The walls were fitted, and the result is not used (walls.html reports it):");
  }
  for (const std::string& reason : report.reasons) {
    html += html_paragraph(reason);
  }
  return html;
}

}  // namespace

std::string expectation(const UnsurveyedReport& report) {
  const std::size_t all = report.access_points.size();
  const std::size_t known = known_of(report);
  if (!report.chains) {
    return "Plan only, nothing is calibrated: " + plan_accuracy(all) + ".";
  }
  const std::string whose =
      known == all ? "Chains" : fmt::format("Chains of {} of {} access points", known, all);
  return fmt::format(
      "{} only, the walls are those of the plan: {}.", whose, chains_accuracy(known));
}

std::vector<std::string> advice(const UnsurveyedReport& report) {
  std::vector<std::string> steps;
  if (report.access_points.size() < kMeasuredWith) {
    steps.emplace_back(
        "Add access points, best up to three (rayloc predict finds where they help most).");
  }
  for (const RefusedInput& one : refused_of(report)) {
    steps.push_back(fmt::format("Learn the chains of {}: {}.", one.what, one.reason));
  }
  if (!report.chains) {
    steps.emplace_back(
        "Record a device that is carried through the whole room for a minute while all access "
        "points receive it, and calibrate with --unsurveyed --capture: this learns the chains, and "
        "fits the walls if enough positions are reliable.");
  } else if (report.reasons.empty() && refused_of(report).empty()) {
    steps.push_back(fmt::format(
        "Record a longer walk through the whole room while all access points receive the device: "
        "{} bursts have a reliable position, and the walls need {}.",
        report.places,
        report.needed));
  } else if (!report.reasons.empty()) {
    steps.push_back("Check the plan: " + report.reasons.front());
  }
  steps.emplace_back(
      "Survey points: rayloc calibrate --plan proposes them, and a calibration from these states "
      "the accuracy at points held out.");
  return steps;
}

Json to_json(const UnsurveyedReport& report) {
  Json refused = Json::array();
  for (const RefusedInput& one : refused_of(report)) {
    refused.push_back({{"what", one.what}, {"reason", one.reason}});
  }
  return {{"method", "unsurveyed"},
          {"verdict",
           {{"success", true},
            {"expectation", expectation(report)},
            {"advice", advice(report)},
            {"reasons", report.reasons}}},
          {"site", report.site},
          {"calibration_id", report.calibration_id},
          {"calibrated", report.chains ? Json::array({"chains"}) : Json::array()},
          {"access_points", chains_json(report)},
          {"places", report.places},
          {"places_needed", report.needed},
          {"bursts", report.bursts},
          {"refused", std::move(refused)}};
}

std::string to_html(const UnsurveyedReport& report) {
  return draw::html_page("Calibration of " + report.site,
                         introduction(expectation(report), advice(report)) +
                             draw::html_section("Receive chains", chain_table(report)) +
                             draw::html_section("Walls", walls_text(report)));
}

}  // namespace rayloc
