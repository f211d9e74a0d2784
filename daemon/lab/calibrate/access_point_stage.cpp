#include "daemon/lab/calibrate/access_point_stage.h"

#include <utility>

namespace rayloc {
namespace {

struct Samples {
  std::vector<CalibrationSample> samples;
  std::vector<std::size_t> point;  // point index of each burst
};

Samples point_samples(std::span<const CalibrationPoint> points,
                      std::size_t access_point,
                      double survey_error,
                      bool with_held_out) {
  Samples result;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto& h = points[p].h[access_point];
    if (!h.empty() && (with_held_out || !points[p].held_out)) {
      result.samples.push_back({points[p].position, h, survey_error});
      result.point.push_back(p);
    }
  }
  return result;
}

}  // namespace

Expected<AccessPointResult> fit_access_point(const RoomModel& room,
                                             std::size_t access_point,
                                             std::span<const CalibrationPoint> points,
                                             double survey_error,
                                             ArrayFit array) {
  AccessPointResult result;
  result.index = access_point;
  const Samples all = point_samples(points, access_point, survey_error, true);
  const AccessPointCalibrator on_all(room, access_point, all.samples);
  auto fit = on_all.fit(array);
  RAYLOC_TRY(fit);
  result.fit = *std::move(fit);
  auto train =
      AccessPointCalibrator(
          room, access_point, point_samples(points, access_point, survey_error, false).samples)
          .fit(array);
  if (!train) {
    train.error().message += " after holding out; use a smaller --holdout";
    return tl::make_unexpected(std::move(train.error()));
  }
  result.train = *std::move(train);
  const auto before = on_all.correlations(nullptr);
  const auto after = on_all.correlations(&result.train);
  for (std::size_t i = 0; i < all.point.size(); ++i) {
    if (before[i] && after[i]) {
      result.fits.push_back({all.point[i], access_point, *before[i], *after[i], 0.0});
    }
  }
  return result;
}

void apply(const AccessPointFit& fit, RoomAccessPoint& access_point) {
  access_point.gains = fit.gains;
  access_point.error = fit.error.value();
  access_point.array.pose.orientation.yaw += fit.yaw_offset.value;
}

}  // namespace rayloc
