#include "engine/calibrate/stated_parameter.h"

#include <cmath>

#include "engine/scene/scene.h"

namespace rayloc {

using Kind = Unknown::Kind;

RoomParameter stated_parameter(const Unknown& unknown,
                               const RoomModel& room,
                               double value,
                               double sigma) {
  RoomParameter parameter{unknown_name(unknown, room), "m", value, 0.0, unknown.sigma, sigma};
  const auto factor_of = [&](double prior, const char* unit) {
    parameter.unit = unit;
    parameter.prior = prior;
    parameter.value = prior * std::exp(value);
    parameter.prior_sigma = prior * unknown.sigma;
    parameter.sigma = parameter.value * sigma;
  };
  switch (unknown.kind) {
    case Kind::kSurfaceOffset:
    case Kind::kElementPosition:
      break;
    case Kind::kSurfaceGain:
    case Kind::kChainGain:
      factor_of(1.0, "1");
      break;
    case Kind::kSurfacePhase:
    case Kind::kArrayAngle:
    case Kind::kChainPhase:
      parameter.unit = "rad";
      break;
    case Kind::kPermittivity:
      factor_of(room.scene->materials()[unknown.index].relative_permittivity, "1");
      break;
    case Kind::kConductivity:
      factor_of(room.scene->materials()[unknown.index].conductivity, "S/m");
      break;
    case Kind::kThickness:
      factor_of(room.scene->materials()[unknown.index].thickness, "m");
      break;
    case Kind::kArrayPosition:
      break;
    case Kind::kCoupling:
      parameter.unit = "1";
      break;
  }
  return parameter;
}

}  // namespace rayloc
