// What SpotFi can be told, and what it assumes where nothing was learned.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/baselines/settings.h"
#include "engine/baselines/spotfi/direct_path.h"

namespace rayloc {

// What tells how far away a device is.
enum class SpotfiRange {
  kLevel,  // its level, where that was learned; differences of levels between access points
  kNone,   // nothing: bearings alone
  kRoom,   // as kLevel, and a single bearing ends at the walls where there is no level
};

struct SpotfiOptions {
  DirectPathOptions path;
  double sigma_psi = 0.45;  // [rad], of a direct path's phase, where nothing was learned
  double outliers = 0.15;   // share of bursts whose direct path is another
  double grid = 0.05;       // [m]
  SpotfiRange range = SpotfiRange::kLevel;
  double accuracy_confidence = 0.95;
  std::uint64_t seed = 1;
};

std::span<const BaselineSetting> spotfi_settings();
// What `values` says, and the standard of all else.
SpotfiOptions spotfi_options(const BaselineValues& values);

}  // namespace rayloc
