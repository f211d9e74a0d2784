#include "engine/em/antenna_pattern.h"

#include <utility>

#include "engine/base/check.h"

namespace rayloc {

AntennaPattern::AntennaPattern(Kind kind) : kind_(kind) { RAYLOC_CHECK(kind != kTable); }

AntennaPattern::AntennaPattern(std::shared_ptr<const AntennaGainTable> table)
    : kind_(kTable), table_(std::move(table)) {
  RAYLOC_CHECK(table_ != nullptr);
}

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
  if (name == "tr38901") {
    return AntennaPattern::kTr38901;
  }
  return std::nullopt;
}

std::string_view to_string(const AntennaPattern& pattern) {
  switch (pattern.kind()) {
    case AntennaPattern::kIsotropic:
      return "isotropic";
    case AntennaPattern::kDipole:
      return "dipole";
    case AntennaPattern::kHalfWaveDipole:
      return "half_wave_dipole";
    case AntennaPattern::kTr38901:
      return "tr38901";
    case AntennaPattern::kTable:
      return "table";
  }
  RAYLOC_CHECK(false);
}

}  // namespace rayloc
