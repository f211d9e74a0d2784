// FitSummary: how well a method explains one access point's bursts at the held-out points.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/report/calibration_report.h"

namespace rayloc {

struct CorrelationSummary {
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double mean = 0.0;
};

struct FitSummary {
  std::size_t points = 0;
  std::optional<CorrelationSummary> before;  // absent without a point
  std::optional<CorrelationSummary> after;
  std::optional<CorrelationSummary> placed;  // PointFit::placed; absent if no method fitted it
};

// Summary of CalibrationReport::located at the held-out points.
std::optional<CorrelationSummary> summarize_located(const CalibrationReport& report,
                                                    std::size_t access_point);

// PointFit::`share` in `fits` for the held-out points of one access point.
std::vector<double> heldout_correlations(const CalibrationReport& report,
                                         std::span<const PointFit> fits,
                                         std::size_t access_point,
                                         double PointFit::*share);

FitSummary summarize_fit(const CalibrationReport& report,
                         const RoomCalibration& calibration,
                         std::size_t access_point);

// "28 of 28 points, median error 0.086 m, ...", or that there were none.
std::string to_text(const HeldOutFixes& fixes);

}  // namespace rayloc
