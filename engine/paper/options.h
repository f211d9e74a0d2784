// Options of method `paper` (METHODS A4), for a device and for a person without one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/observe/burst.h"
#include "engine/paper/csi_loss.h"
#include "engine/paper/descent.h"

namespace rayloc::paper {

// The defaults are the paper's values for device-based localization.
struct LocalizerOptions {
  CsiLossOptions csi;
  double centre_weight = 0.05;  // gamma_2 [1/m^2]; 0 leaves the term out
  DescentOptions descent;
  std::size_t starts = 1;      // random starts; the least final loss wins
  std::optional<Vec3d> start;  // replaces the first random start
  std::uint64_t seed = 1;
  BurstOptions burst;
};

// The paper's defaults for device-free localization: gamma_1 = gamma_2 = 2, sigma_0^2 = 0.1 m^2,
// alpha = 1; the rest as for devices.
LocalizerOptions person_options();

// An Error (kUsage) for invalid numbers.
Expected<void> validate(const LocalizerOptions& options);

}  // namespace rayloc::paper
