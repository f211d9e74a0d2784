// fit_level: what an access point states as the level of a transmitter of constant power, from what
// it heard of it at surveyed points (engine/likelihood/level.h has the likelihood).
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "engine/base/vec3.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct LevelSample {
  Vec3d position;          // [m], surveyed
  double level_dbm = 0.0;  // BurstObservation::level_dbm
};

struct LevelFit {
  double offset_db = 0.0;  // mean of the levels less what is traced
  double sigma_db = 0.0;   // their standard deviation about it
  std::size_t samples = 0;
};

// A count, chosen: the spread of fewer is not known.
inline constexpr std::size_t kLeastLevelSamples = 10;

// Of the room as calibrated: its device, rays and diffuse power. Nothing with fewer points than
// kLeastLevelSamples that a ray leads to.
std::optional<LevelFit> fit_level(const RoomModel& room,
                                  std::size_t access_point,
                                  std::span<const LevelSample> samples);

}  // namespace rayloc
