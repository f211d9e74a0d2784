// fit_power_offset: received power that an access point reports for a transmitter of constant
// power, from observations at surveyed points (engine/likelihood/received_power.h has the
// likelihood).
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "engine/base/vec3.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PowerSample {
  Vec3d position;          // [m], surveyed
  double power_dbm = 0.0;  // BurstObservation::power_dbm
};

struct PowerOffsetFit {
  double offset_db = 0.0;  // mean of measured minus traced power
  double sigma_db = 0.0;   // standard deviation of the difference
  std::size_t samples = 0;
};

// A count, chosen: the spread of fewer samples is not known.
inline constexpr std::size_t kMinPowerSamples = 10;

// `room` is the calibrated one: its device, rays and diffuse power are used. nullopt with fewer
// than kMinPowerSamples points that a ray reaches.
std::optional<PowerOffsetFit> fit_power_offset(const RoomModel& room,
                                               std::size_t access_point,
                                               std::span<const PowerSample> samples);

}  // namespace rayloc
