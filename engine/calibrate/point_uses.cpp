#include "engine/calibrate/point_uses.h"

#include <algorithm>
#include <random>
#include <string>

namespace rayloc {
namespace {

constexpr double kDecidingShare = 0.15;  // of the points that are not held out
constexpr std::size_t kLeastPoints = 4;

bool is_heard(const CalibrationPoint& point) {
  return std::any_of(point.h.begin(), point.h.end(), [](const auto& one) { return !one.empty(); });
}

}  // namespace

std::vector<Use> draw_uses(std::span<const CalibrationPoint> points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Use> uses;
  uses.reserve(points.size());
  for (const CalibrationPoint& point : points) {
    const double drawn = static_cast<double>(random() >> 11) * 0x1p-53;
    uses.push_back(point.held_out           ? Use::kHeldOut
                   : drawn < kDecidingShare ? Use::kDecide
                                            : Use::kFit);
  }
  return uses;
}

std::size_t fitted_points(std::span<const CalibrationPoint> points, std::span<const Use> uses) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    count += uses[p] != Use::kHeldOut && is_heard(points[p]) ? 1U : 0U;
  }
  return count;
}

Expected<void> check_uses(const RoomModel& room,
                          std::span<const CalibrationPoint> points,
                          std::span<const Use> uses) {
  bool anything = false;
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    std::size_t heard = 0;
    std::size_t usable = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (a < points[p].h.size() && !points[p].h[a].empty()) {
        ++heard;
        usable += uses[p] == Use::kFit ? 1U : 0U;
      }
    }
    if (heard > 0 && usable < kLeastPoints) {
      return bad_input("access point " + room.access_points[a].id + ": " + std::to_string(usable) +
                       " calibration points can be fitted, at least " +
                       std::to_string(kLeastPoints) + " are needed");
    }
    anything = anything || heard > 0;
  }
  if (!anything) {
    return bad_input("no access point heard the device at any of the points");
  }
  return {};
}

}  // namespace rayloc
