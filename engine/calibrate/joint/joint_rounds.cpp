#include "engine/calibrate/joint/joint_rounds.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace rayloc {
namespace {

// Chosen, in the order of METHODS B4: floors decrease and more is released from round to round.
constexpr std::array<JointRound, kJointRounds> kRounds{{{0.3, 0.05, false, false, false},
                                                        {0.12, 0.03, true, false, false},
                                                        {0.05, 0.03, true, true, true},
                                                        {0.03, 0.03, true, true, false}}};
constexpr double kMinRoundPower = 1e-4;  // of the strongest surface's power

}  // namespace

const JointRound& joint_round(std::size_t index) { return kRounds.at(index); }

std::vector<char> released(const JointRound& round,
                           const RoomUnknowns& unknowns,
                           std::span<const double> power) {
  using Kind = Unknown::Kind;
  std::vector<char> result(unknowns.size());
  const double most = *std::max_element(power.begin(), power.end());
  for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
    const Unknown& unknown = unknowns[i];
    switch (unknown.kind) {
      case Kind::kSurfaceOffset:
        result[i] = power[unknown.index] > kMinRoundPower * most ? 1 : 0;
        break;
      case Kind::kSurfaceGain:
      case Kind::kSurfacePhase:
        result[i] = round.corrections && power[unknown.index] > kMinRoundPower * most ? 1 : 0;
        break;
      case Kind::kPermittivity:
      case Kind::kConductivity:
      case Kind::kThickness:
        result[i] = round.corrections ? 1 : 0;
        break;
      case Kind::kElementPosition:
      case Kind::kCoupling:
        result[i] = round.survey ? 1 : 0;
        break;
      default:
        result[i] = 1;
    }
  }
  return result;
}

}  // namespace rayloc
