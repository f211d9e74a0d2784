#include "daemon/lab/calibrate/report/fit_summary.h"

#include <numeric>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/evaluate/error_statistics.h"

namespace rayloc {
namespace {

std::optional<CorrelationSummary> summarize(const std::vector<double>& values) {
  if (values.empty()) {
    return std::nullopt;
  }
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return CorrelationSummary{percentile(values, 0.25),
                            percentile(values, 0.5),
                            percentile(values, 0.75),
                            sum / static_cast<double>(values.size())};
}

}  // namespace

std::vector<double> heldout_correlations(const CalibrationReport& report,
                                         std::span<const PointFit> fits,
                                         std::size_t access_point,
                                         double PointFit::*share) {
  std::vector<double> values;
  for (const PointFit& fit : fits) {
    if (fit.access_point == access_point && report.held_out.at(fit.point)) {
      values.push_back(fit.*share);
    }
  }
  return values;
}

FitSummary summarize_fit(const CalibrationReport& report,
                         const RoomCalibration& calibration,
                         std::size_t access_point) {
  const auto before =
      heldout_correlations(report, calibration.points, access_point, &PointFit::before);
  const auto after =
      heldout_correlations(report, calibration.points, access_point, &PointFit::after);
  auto placed = heldout_correlations(report, calibration.points, access_point, &PointFit::placed);
  std::erase(placed, 0.0);
  return {after.size(), summarize(before), summarize(after), summarize(placed)};
}

std::optional<CorrelationSummary> summarize_located(const CalibrationReport& report,
                                                    std::size_t access_point) {
  return summarize(heldout_correlations(report, report.located, access_point, &PointFit::after));
}

std::string to_text(const HeldOutFixes& fixes) {
  if (fixes.points == 0) {
    return "no point was held out: the accuracy of the calibration is unknown";
  }
  const std::string error = fixes.median_error_m
                                ? fmt::format(
                                      ", median error {:.3f} m, {} within the stated 95 % "
                                      "radius",
                                      *fixes.median_error_m,
                                      fixes.within_accuracy)
                                : "";
  return fmt::format("{} of {} points{} (likelihood exponent {:g})",
                     fixes.fixes,
                     fixes.points,
                     error,
                     fixes.likelihood_exponent);
}

}  // namespace rayloc
