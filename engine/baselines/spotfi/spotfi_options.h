// Options of SpotFi, and the defaults without training.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/baselines/settings.h"
#include "engine/baselines/spotfi/direct_path.h"

namespace rayloc {

// Source of the distance of a device.
enum class SpotfiRange {
  kPower,  // received power if learned; differences of powers between access points
  kNone,   // none: bearings only
  kRoom,   // as kPower; a single bearing without a power ends at the walls
};

struct SpotfiOptions {
  DirectPathOptions path;
  double sigma_psi = 0.45;  // [rad], of a direct path's phase, without training
  double outliers = 0.15;   // share of bursts with a wrong direct path
  double grid = 0.05;       // [m]
  SpotfiRange range = SpotfiRange::kPower;
  double accuracy_confidence = 0.95;
  std::uint64_t seed = 1;
};

std::span<const BaselineSetting> spotfi_settings();
// The options in `values`, and defaults for all others.
SpotfiOptions spotfi_options(const BaselineValues& values);

}  // namespace rayloc
