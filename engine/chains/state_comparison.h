// Which states of receive chains explain the remembered bursts of an access point, and how well.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/chains/chain_evidence.h"
#include "engine/chains/chain_refinement.h"
#include "engine/localize/access_point_map.h"

namespace rayloc {

// A burst that counted.
struct RememberedBurst {
  std::vector<std::complex<double>> h;  // the factors believed now undone
  Timestamp time;
  double noise = 0.0;
  double floor = 0.0;  // PlacedBurst
  TurnEvidence evidence;
  std::vector<float> log_weight;  // [cell], ln of how likely the device is there, by the others
  std::vector<std::complex<double>> since;  // by what factors have changed since the evidence
  // Of a transmitter whose place is known; null: it may be anywhere, and `evidence` says where.
  std::shared_ptr<const PlaceModel> known_place = nullptr;
};

// States that are nearer are one [rad].
inline constexpr double kSameState = 0.7;
// [rad], of the chain that differs most.
double distance(const std::vector<std::complex<double>>& a,
                const std::vector<std::complex<double>>& b);
std::vector<std::complex<double>> inverses(const std::vector<std::complex<double>>& factors);
// h: [chain][tone].
void multiply(const std::vector<std::complex<double>>& factors,
              std::vector<std::complex<double>>& h);

// From each start, a state against what is believed now, to where it explains most; those that
// differ then, the best first. REQUIRES: starts and bursts not empty.
std::vector<ChainFactors> compare_states(const AccessPointMap& map,
                                         std::span<const RememberedBurst> heard,
                                         std::span<const std::vector<std::complex<double>>> starts,
                                         double likelihood_exponent);

}  // namespace rayloc
