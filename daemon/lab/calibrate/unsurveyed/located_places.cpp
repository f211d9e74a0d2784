#include "daemon/lab/calibrate/unsurveyed/located_places.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/calibrate/device_bursts.h"
#include "engine/chains/chain_frames.h"
#include "engine/localize/localizer.h"

namespace rayloc {
namespace {

constexpr double kSure = 0.9;            // probability of the first hypothesis, chosen
constexpr double kLargestSigma = 0.1;    // [m], largest error of a survey
constexpr std::size_t kMaxPoints = 200;  // count, chosen: as in a survey of a large room

// Every n-th index, so that at most kMaxPoints are left.
std::vector<std::size_t> spread(std::size_t count) {
  std::vector<std::size_t> kept;
  const std::size_t most = std::min(count, kMaxPoints);
  kept.reserve(most);
  for (std::size_t i = 0; i < most; ++i) {
    kept.push_back(i * count / most);
  }
  return kept;
}

}  // namespace

Expected<LocatedPlaces> located_places(const Site& site,
                                       const RoomModel& room,
                                       const std::vector<CaptureArgument>& captures,
                                       std::vector<std::string>& notes) {
  const auto received = read_device_bursts(site, captures, notes);
  RAYLOC_TRY(received);
  const auto localizer = device_localizer(site, room);
  RAYLOC_TRY(localizer);
  std::vector<SurveyPoint> points;
  std::vector<double> sigmas;
  LocatedPlaces found;
  for (const std::vector<CsiFrame>& burst : received->bursts) {
    if (find_fixed_transmitter(site, burst.front().transmitter) != nullptr) {
      continue;
    }
    ++found.bursts;
    const LocationEstimate estimate = (*localizer)->locate(first_moment(burst));
    if (!estimate.position || estimate.hypotheses.empty()) {
      continue;
    }
    const Hypothesis& first = estimate.hypotheses.front();
    const double sigma = std::sqrt(0.5 * (first.covariance[0] + first.covariance[4]));
    if (first.weight >= kSure && sigma <= kLargestSigma) {
      points.push_back({estimate.capture_start, estimate.capture_end, first.position});
      sigmas.push_back(sigma);
    }
  }
  for (const std::size_t i : spread(points.size())) {
    found.points.push_back(points[i]);
  }
  if (!sigmas.empty()) {
    const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
    std::nth_element(sigmas.begin(), middle, sigmas.end());
    found.sigma = *middle;
  }
  return found;
}

std::string to_csv(const std::vector<SurveyPoint>& points) {
  // The csv has a coarser time resolution than the frames.
  constexpr auto kMargin = std::chrono::microseconds(10);
  const auto seconds = [](Timestamp time) {
    return std::chrono::duration<double>(time.time_since_epoch()).count();
  };
  std::string csv = "t_start,t_end,x,y,z\n";
  for (const SurveyPoint& point : points) {
    csv += fmt::format("{:.6f},{:.6f},{:.4f},{:.4f},{:.4f}\n",
                       seconds(point.t_start - kMargin),
                       seconds(point.t_end + kMargin),
                       point.position.x,
                       point.position.y,
                       point.position.z);
  }
  return csv;
}

}  // namespace rayloc
