#include "engine/room/parameter_id.h"

#include <array>
#include <utility>

namespace rayloc {
namespace {

using Ending = std::pair<Quantity, std::string_view>;

// An ending of two words precedes the one that it ends with.
constexpr std::array kEndings = {
    Ending{Quantity::kSurfaceOffset, ".offset"},
    Ending{Quantity::kGain, ".gain"},
    Ending{Quantity::kPhase, ".phase"},
    Ending{Quantity::kRelativePermittivity, ".relative_permittivity"},
    Ending{Quantity::kConductivity, ".conductivity"},
    Ending{Quantity::kThickness, ".thickness"},
    Ending{Quantity::kPositionX, ".position.x"},
    Ending{Quantity::kPositionY, ".position.y"},
    Ending{Quantity::kPositionZ, ".position.z"},
    Ending{Quantity::kYaw, ".yaw"},
    Ending{Quantity::kPitch, ".pitch"},
    Ending{Quantity::kRoll, ".roll"},
    Ending{Quantity::kYawOffset, ".yaw_offset"},
    Ending{Quantity::kElementY, ".element_y"},
    Ending{Quantity::kCouplingReal, ".coupling.re"},
    Ending{Quantity::kCouplingImaginary, ".coupling.im"},
    Ending{Quantity::kPlanTolerance, ".plan_tolerance"},
    Ending{Quantity::kDiffuse, ".diffuse"},
    Ending{Quantity::kDiffuseExponent, ".diffuse_exponent"},
    Ending{Quantity::kDiffuseDecayTime, ".diffuse_decay"},
    Ending{Quantity::kNoise, ".noise"},
    Ending{Quantity::kTranslationX, ".x"},
    Ending{Quantity::kTranslationY, ".y"},
    Ending{Quantity::kTranslationZ, ".z"},
};

}  // namespace

std::string to_string(const ParameterId& id) {
  for (const auto& [quantity, ending] : kEndings) {
    if (quantity == id.quantity) {
      return id.of + std::string(ending);
    }
  }
  return id.of;
}

ParameterId parse_parameter_id(std::string_view name) {
  for (const auto& [quantity, ending] : kEndings) {
    if (name.ends_with(ending)) {
      return {std::string(name.substr(0, name.size() - ending.size())), quantity};
    }
  }
  return {std::string(name), Quantity::kOther};
}

}  // namespace rayloc
