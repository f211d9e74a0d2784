// What each calibration point is for.
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
  kDecide,   // kept from the fit: says whether what it found is better
  kHeldOut,  // only looked at
};
inline constexpr std::array kFitted{Use::kFit};  // the uses whose points a round is fitted to
// The uses whose points judge a round (METHODS B4, step 6).
inline constexpr std::array kDeciding{Use::kDecide};
// The uses that the last fit joins.
inline constexpr std::array kAllButHeldOut{Use::kFit, Use::kDecide};
inline constexpr std::array kHeldOut{Use::kHeldOut};  // the uses that no fit and no decision sees

// Of each point. Those that decide are drawn without replacement from what was heard and is not
// held out: 15 in 100, three at least, unless that were more than a quarter.
std::vector<Use> draw_uses(std::span<const CalibrationPoint> points, std::uint64_t seed);

// Those that decide; of so few points that none can be spared, those that are fitted.
std::span<const Use> deciders(std::span<const Use> uses);

// How many points are heard and not held out.
std::size_t fitted_points(std::span<const CalibrationPoint> points, std::span<const Use> uses);

// An error that names the access point that heard too few points to be fitted.
Expected<void> check_uses(const RoomModel& room,
                          std::span<const CalibrationPoint> points,
                          std::span<const Use> uses);

}  // namespace rayloc
