#include "engine/em/antenna_pattern.h"

#include "engine/base/check.h"

namespace rayloc {

std::optional<AntennaPattern> parse_antenna_pattern(std::string_view name) {
  if (name == "isotropic" || name == "iso") {
    return AntennaPattern::kIsotropic;
  }
  if (name == "dipole") {
    return AntennaPattern::kDipole;
  }
  if (name == "half_wave_dipole" || name == "hw_dipole") {
    return AntennaPattern::kHalfWaveDipole;
  }
  return std::nullopt;
}

std::string_view to_string(AntennaPattern pattern) {
  switch (pattern) {
    case AntennaPattern::kIsotropic:
      return "isotropic";
    case AntennaPattern::kDipole:
      return "dipole";
    case AntennaPattern::kHalfWaveDipole:
      return "half_wave_dipole";
  }
  RAYLOC_CHECK(false);
}

}  // namespace rayloc
