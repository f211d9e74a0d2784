#include "engine/calibrate/point_uses.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <utility>

namespace rayloc {
namespace {

constexpr double kDecidingShare = 0.15;   // of the points that are not held out
constexpr std::size_t kMinPoints = 4;     // a count, chosen: as AccessPointCalibrator::kMinSamples
constexpr std::size_t kMinDeciding = 3;   // a median of fewer depends on one point
constexpr std::size_t kDecidingPart = 4;  // at most one in this many points decides

// Number of deciding points among `count` points.
std::size_t deciding_points(std::size_t count) {
  const auto share =
      static_cast<std::size_t>(std::lround(kDecidingShare * static_cast<double>(count)));
  const std::size_t spare = count > kMinPoints ? count - kMinPoints : 0;
  return std::min({std::max(share, kMinDeciding), count / kDecidingPart, spare});
}

bool is_received(const CalibrationPoint& point) {
  return std::any_of(point.h.begin(), point.h.end(), [](const auto& one) { return !one.empty(); });
}

}  // namespace

std::vector<Use> draw_uses(std::span<const CalibrationPoint> points, std::uint64_t seed) {
  std::vector<Use> uses;
  std::vector<std::size_t> drawable;
  uses.reserve(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    uses.push_back(points[p].held_out ? Use::kHeldOut : Use::kFit);
    if (!points[p].held_out && is_received(points[p])) {
      drawable.push_back(p);
    }
  }
  std::mt19937_64 random(seed);
  for (std::size_t i = drawable.size(); i > 1; --i) {
    std::swap(drawable[i - 1], drawable[random() % i]);
  }
  drawable.resize(deciding_points(drawable.size()));
  for (const std::size_t p : drawable) {
    uses[p] = Use::kDecide;
  }
  return uses;
}

std::span<const Use> deciders(std::span<const Use> uses) {
  const bool some = std::find(uses.begin(), uses.end(), Use::kDecide) != uses.end();
  return some ? std::span<const Use>(kDeciding) : std::span<const Use>(kFitted);
}

std::size_t fitted_points(std::span<const CalibrationPoint> points, std::span<const Use> uses) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    count += uses[p] != Use::kHeldOut && is_received(points[p]) ? 1U : 0U;
  }
  return count;
}

Expected<void> check_uses(const RoomModel& room,
                          std::span<const CalibrationPoint> points,
                          std::span<const Use> uses) {
  bool anything = false;
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    std::size_t received = 0;
    std::size_t usable = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (a < points[p].h.size() && !points[p].h[a].empty()) {
        ++received;
        usable += uses[p] == Use::kFit ? 1U : 0U;
      }
    }
    if (received > 0 && usable < kMinPoints) {
      return bad_input("access point " + room.access_points[a].id + ": " + std::to_string(usable) +
                       " calibration points can be fitted, at least " + std::to_string(kMinPoints) +
                       " are needed");
    }
    anything = anything || received > 0;
  }
  if (!anything) {
    return bad_input("no access point received the device at any of the points");
  }
  return {};
}

}  // namespace rayloc
