#include "engine/calibrate/joint/stated_parameter.h"

#include <cmath>
#include <numbers>

#include "engine/base/constants.h"
#include "engine/scene/scene.h"

namespace rayloc {

using Kind = Unknown::Kind;

RoomParameter stated_parameter(const Unknown& unknown,
                               const RoomModel& room,
                               double value,
                               double sigma) {
  RoomParameter parameter{{value, 0.0, sigma}, parameter_id(unknown, room), "m", unknown.sigma};
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

std::complex<double> chain_ratio(const ChainGains& gains, std::size_t element) {
  const std::size_t tones = gains.grid.size();
  std::complex<double> ratio;
  double power = 0.0;
  for (std::size_t k = 0; k < tones; ++k) {
    ratio += gains.gain[element * tones + k] * std::conj(gains.gain[k]);
    power += std::norm(gains.gain[k]);
  }
  return ratio / power;
}

RoomParameter stated_chain(const Unknown& unknown,
                           const RoomModel& room,
                           const ChainGains& assumed,
                           const ChainGains& found,
                           double sigma) {
  constexpr double kDecibels = 20.0 * std::numbers::log10e;  // of one neper
  const bool phase = unknown.kind == Kind::kChainPhase;
  const double unit = phase ? kDegreesPerRadian : kDecibels;
  const std::complex<double> before = chain_ratio(assumed, unknown.part);
  const std::complex<double> rotated = chain_ratio(found, unknown.part) / before;
  const auto part = [&](const std::complex<double>& ratio) {
    return unit * (phase ? std::arg(ratio) : std::log(std::abs(ratio)));
  };
  return {{part(before) + part(rotated), part(before), unit * sigma},
          parameter_id(unknown, room),
          phase ? "deg" : "dB",
          unit * unknown.sigma};
}

}  // namespace rayloc
