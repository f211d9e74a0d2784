#include "daemon/lab/calibrate/report/expectation.h"

#include <algorithm>
#include <optional>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/calibrate/report/fit_summary.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

// Shares of explained power, chosen: above the first, the walls are where the site states; below
// the second, diffuse power and clutter are as strong as the traced paths.
constexpr double kGoodShare = 0.8;
constexpr double kUsableShare = 0.5;
// [m], chosen: a desk, and the half of a small room.
constexpr double kGoodError = 0.1;
constexpr double kUsableError = 0.5;
constexpr double kGoodFixes = 0.9;  // ratio, chosen: held-out points that have a fix
// Share of power, chosen: the least deficit to the best access
// point, or between two columns of the table, that is reported.
constexpr double kMuchLess = 0.15;
constexpr double kWorthTrying = 1.0;    // standard errors by which another input explains more
constexpr std::size_t kFewPoints = 36;  // points of a survey that can reveal its own errors

struct Explained {
  std::string access_point;
  double share = 0.0;                 // median of the held-out points, as located if available
  std::optional<double> placed = {};  // the same with the positions of the points fitted
};

std::vector<Explained> explained(const CalibrationReport& report) {
  std::vector<Explained> all;
  for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
    const FitSummary fit = summarize_fit(report, report.methods.front().calibration, ap);
    if (!fit.after) {
      continue;
    }
    const auto located = summarize_located(report, ap);
    all.push_back({report.access_points[ap], located ? located->median : fit.after->median});
    if (fit.placed) {
      all.back().placed = fit.placed->median;
    }
  }
  return all;
}

// Access points that explain much less than the best one.
std::vector<Explained> behind(const std::vector<Explained>& all) {
  double best = 0.0;
  for (const Explained& one : all) {
    best = std::max(best, one.share);
  }
  std::vector<Explained> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found), [&](const Explained& one) {
    return one.share < kGoodShare && one.share < best - kMuchLess;
  });
  return found;
}

// The error at that access point that explains more than the inputs do, if not clearly.
std::string suspicion(const CalibrationReport& report, const std::string& access_point) {
  for (const TriedMistake& one : report.verdict.tried) {
    if (one.kind == TriedMistake::Kind::kArray && one.gained > 0.0 &&
        one.significance > kWorthTrying &&
        one.what.find('\'' + access_point + '\'') != std::string::npos) {
      return " (" + one.what + "?)";
    }
  }
  return "";
}

std::string length(double metres) {
  constexpr double kAsMetres = 0.995;  // rounds to a hundred centimetres
  return metres < kAsMetres ? fmt::format("{:.2g} cm", 100.0 * metres)
                            : fmt::format("{:.1f} m", metres);
}

double least_share(const std::vector<Explained>& all) {
  double least = 1.0;
  for (const Explained& one : all) {
    least = std::min(least, one.share);
  }
  return least;
}

bool is_good(const CalibrationReport& report, const std::vector<Explained>& all) {
  const HeldOutFixes& taken = report.fixes.back();
  return taken.median_error_m && *taken.median_error_m <= kGoodError &&
         least_share(all) >= kGoodShare &&
         static_cast<double>(taken.fixes) >= kGoodFixes * static_cast<double>(taken.points);
}

const char* grade(const CalibrationReport& report, const std::vector<Explained>& all) {
  if (is_good(report, all)) {
    return "Good";
  }
  const bool is_usable =
      *report.fixes.back().median_error_m <= kUsableError && least_share(all) >= kUsableShare;
  return is_usable ? "Usable" : "Doubtful";
}

}  // namespace

std::string expectation(const CalibrationReport& report) {
  RAYLOC_CHECK(!report.methods.empty());
  if (!report.verdict.is_success()) {
    return "No success: " + report.verdict.reasons.front();
  }
  const std::vector<Explained> all = explained(report);
  if (all.empty() || report.fixes.empty() || report.fixes.back().points == 0) {
    return "Accuracy unknown: no point was held out.";
  }
  const HeldOutFixes& taken = report.fixes.back();
  if (!taken.median_error_m) {
    return fmt::format("Doubtful: none of the {} points held out has a fix.", taken.points);
  }
  std::string text = fmt::format(
      "{}: expect {} with {} access point{} (median of {} point{} held "
      "out, {} of them with a fix)",
      grade(report, all),
      length(*taken.median_error_m),
      all.size(),
      all.size() == 1 ? "" : "s",
      taken.points,
      taken.points == 1 ? "" : "s",
      taken.fixes);
  for (const Explained& one : behind(all)) {
    text += fmt::format("; {} is doubtful, it explains {:.0f} % of the CSI it received{}",
                        one.access_point,
                        100.0 * one.share,
                        suspicion(report, one.access_point));
  }
  return text + '.';
}

std::vector<std::string> advice(const CalibrationReport& report) {
  const std::vector<Explained> all = explained(report);
  std::vector<std::string> found;
  for (const Explained& one : behind(all)) {
    found.push_back("Check " + one.access_point +
                    ": its orientation, the order of its antennas, and objects in front of it.");
  }
  const auto is_misplaced = [](const Explained& one) {
    return one.placed && *one.placed > one.share + kMuchLess;
  };
  if (std::any_of(all.begin(), all.end(), is_misplaced)) {
    found.push_back(fmt::format(
        "Measure the points of the survey more exactly{}: with their places fitted much more is "
        "explained.",
        report.survey_error_is == "stated"
            ? ", or leave out --survey-error, or state one above " + length(report.survey_error)
            : ""));
  }
  if (all.size() == 1) {
    found.emplace_back(
        "Add an access point: with one, only the received power separates places with similar CSI "
        "(rayloc predict finds where it helps most).");
  }
  if (report.positions.size() < kFewPoints && !(report.fixes.empty() || is_good(report, all))) {
    found.push_back(fmt::format(
        "Survey more points: {} hardly separate a mistake of the survey from one of the room "
        "(rayloc calibrate --plan proposes {}).",
        report.positions.size(),
        kFewPoints));
  }
  return found;
}

}  // namespace rayloc
