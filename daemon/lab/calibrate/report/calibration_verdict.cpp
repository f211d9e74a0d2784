#include "daemon/lab/calibrate/report/calibration_verdict.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/calibrate/report/calibration_report.h"
#include "daemon/lab/calibrate/report/fit_summary.h"

namespace rayloc {
namespace {

// True if both the median and the mean have fallen: if
// only one falls, points were exchanged for others.
bool has_fallen(const FitSummary& fit) {
  return fit.points >= kMinPairs && fit.before && fit.after &&
         fit.after->median < fit.before->median && fit.after->mean < fit.before->mean;
}

std::string hint(const CalibrationVerdict& verdict) {
  if (!verdict.found.empty() || verdict.tried.empty()) {
    return "";
  }
  const TriedMistake& nearest = verdict.tried.front();
  return fmt::format(
      "none of {} usual mistakes explains the survey clearly better; the nearest: {} (mean "
      "correlation {:.2f}, as stated {:.2f}). Check the origin and the unit of the points, their "
      "times against the clock of the recordings, the channel and the heights\n",
      verdict.tried.size(),
      nearest.what,
      nearest.explained,
      nearest.stated);
}

}  // namespace

CalibrationVerdict verdict_of_inputs(const InputCheck& check) {
  CalibrationVerdict verdict{{}, check.found, check.tried};
  for (const TriedMistake& one : check.found) {
    verdict.reasons.push_back(one.message);
  }
  return verdict;
}

void judge_held_out(const CalibrationReport& report, CalibrationVerdict& verdict) {
  const RoomCalibration& calibration = report.methods.front().calibration;
  if (calibration.interrupted) {
    return;
  }
  for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
    const FitSummary fit = summarize_fit(report, calibration, ap);
    if (has_fallen(fit)) {
      verdict.reasons.push_back(
          fmt::format("access point '{}': at the {} points held out the calibration explains less "
                      "({:.3f}, median of the correlations) than the plan did ({:.3f})",
                      report.access_points[ap],
                      fit.points,
                      fit.after->median,
                      fit.before->median));
    }
  }
  if (report.fixes.empty()) {
    return;
  }
  const HeldOutFixes& taken = report.fixes.back();
  if (taken.points >= kMinJudged && 2 * taken.fixes <= taken.points) {
    verdict.reasons.push_back(
        fmt::format("{} of the {} points held out have no fix: diffuse scattering alone explains "
                    "their CSI as well as the calibrated room does",
                    taken.points - taken.fixes,
                    taken.points));
  }
}

void add_carriers(const std::vector<TriedMistake>& carriers, CalibrationVerdict& verdict) {
  for (const TriedMistake& one : carriers) {
    if (is_clear(one) && (verdict.found.empty() || one.gained > verdict.found.front().gained)) {
      verdict.found = {one};
    }
    verdict.tried.push_back(one);
  }
  std::stable_sort(verdict.tried.begin(), verdict.tried.end(), [](const auto& a, const auto& b) {
    return a.gained > b.gained;
  });
  for (const TriedMistake& one : verdict.found) {
    verdict.reasons.push_back(one.message);
  }
}

std::string to_text(const CalibrationVerdict& verdict) {
  std::string text;
  for (const std::string& reason : verdict.reasons) {
    text += reason + "\n";
  }
  return verdict.is_success() ? "" : text + hint(verdict);
}

}  // namespace rayloc
