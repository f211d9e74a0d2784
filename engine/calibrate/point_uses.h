// Use of each calibration point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

enum class Use : std::uint8_t {
  kFit,
  kDecide,   // kept from the fit: decides whether its result is better
  kHeldOut,  // evaluated only
};
inline constexpr std::array kFitted{Use::kFit};  // the uses whose points a round is fitted to
// The uses whose points evaluate a round (METHODS B4, step 6).
inline constexpr std::array kDeciding{Use::kDecide};
// The uses that enter the last fit.
inline constexpr std::array kAllButHeldOut{Use::kFit, Use::kDecide};
inline constexpr std::array kHeldOut{Use::kHeldOut};  // the uses that enter no fit and no decision

// The use of each point. Deciding points are drawn without replacement from the received points
// that are not held out: 15 in 100, at least three, but at most a quarter.
std::vector<Use> draw_uses(std::span<const CalibrationPoint> points, std::uint64_t seed);

// The deciding points; with too few points to spare any, the fitted ones.
std::span<const Use> deciders(std::span<const Use> uses);

// Number of points that were received and are not held out.
std::size_t fitted_points(std::span<const CalibrationPoint> points, std::span<const Use> uses);

// An Error names an access point that received too few points for a fit.
Expected<void> check_uses(const RoomModel& room,
                          std::span<const CalibrationPoint> points,
                          std::span<const Use> uses);

}  // namespace rayloc
