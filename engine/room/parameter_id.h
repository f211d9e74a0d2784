// ParameterId: identifies a fitted number of the model: a quantity and the part of the room.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rayloc {

enum class Quantity : std::uint8_t {
  kSurfaceOffset,
  kGain,   // of a surface, or of a chain relative to the first
  kPhase,  // likewise
  kRelativePermittivity,
  kConductivity,
  kThickness,
  kPositionX,
  kPositionY,
  kPositionZ,
  kYaw,
  kPitch,
  kRoll,
  kYawOffset,  // from the chain gains alone, for an array that does not move
  kElementY,
  kCouplingReal,
  kCouplingImaginary,
  kPlanTolerance,
  kDiffuse,
  kDiffuseExponent,
  kDiffuseDecayTime,
  kNoise,
  kTranslationX,
  kTranslationY,
  kTranslationZ,
  kOther,  // not fitted by this program; `of` is the whole name
};

struct ParameterId {
  // "wall_west.+x", "ap1", "ap1.core1/core0", "plasterboard".
  std::string of;
  Quantity quantity = Quantity::kOther;

  bool operator==(const ParameterId&) const = default;
};

// "wall_west.+x.offset", "ap1.position.x", "ap1.core1/core0.phase", as files and reports write it.
std::string to_string(const ParameterId& id);
// The inverse; kOther where the end of the name is no quantity.
ParameterId parse_parameter_id(std::string_view name);

}  // namespace rayloc
