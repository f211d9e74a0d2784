#include "engine/calibrate/joint/multi_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {

int usual_draws(std::span<const CalibrationPoint> points) {
  // Received arrays, chosen: up to this count three draws, each takes little time.
  constexpr std::size_t kFewReceived = 100;
  constexpr std::size_t kManyReceived = 200;  // received arrays, chosen: two draws, above it one
  std::size_t received = 0;
  for (const CalibrationPoint& point : points) {
    received += static_cast<std::size_t>(std::count_if(
        point.h.begin(), point.h.end(), [](const auto& one) { return !one.empty(); }));
  }
  return received <= kFewReceived ? 3 : received <= kManyReceived ? 2 : 1;
}

double left_unexplained(std::span<const CalibrationPoint> points,
                        const RoomCalibration& calibration) {
  constexpr double kFloor = 0.03;  // as in the last round (joint_rounds.h)
  double sum = 0.0;
  std::size_t count = 0;
  for (const PointFit& fit : calibration.points) {
    if (!points[fit.point].held_out) {
      sum += std::log(kFloor + 1.0 - fit.placed);
      ++count;
    }
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

Expected<RoomCalibration> calibrate_from_draws(const RoomModel& room,
                                               std::span<const CalibrationPoint> points,
                                               const JointCalibrationOptions& options,
                                               int draws,
                                               const CalibrationObserver& observer) {
  RAYLOC_CHECK(draws > 0);
  CalibrationObserver of_draw;
  int draw = 0;
  if (observer) {
    of_draw = [&](CalibrationProgress progress) {
      progress.share = (draw + progress.share) / draws;
      return observer(progress);
    };
  }
  auto best = calibrate_jointly(room, points, options, of_draw);
  for (draw = 1; draw < draws && best && !best->interrupted; ++draw) {
    JointCalibrationOptions other = options;
    other.seed = options.seed + static_cast<std::uint64_t>(draw);
    other.resume = nullptr;
    other.on_checkpoint = nullptr;
    auto found = calibrate_jointly(room, points, other, of_draw);
    if (!found) {
      return found;
    }
    if (found->interrupted) {
      best->interrupted = true;
    } else if (left_unexplained(points, *found) < left_unexplained(points, *best)) {
      best = std::move(found);
    }
  }
  return best;
}

}  // namespace rayloc
