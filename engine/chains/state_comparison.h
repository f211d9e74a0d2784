// Comparison of receive-chain states by how well they explain the remembered bursts.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/chains/chain_evidence.h"
#include "engine/chains/chain_refinement.h"
#include "engine/localize/access_point_map.h"

namespace rayloc {

// A burst used as evidence.
struct RememberedBurst {
  std::vector<std::complex<double>> h;  // accepted factors removed
  Timestamp time;
  double noise = 0.0;
  double floor = 0.0;  // PlacedBurst::floor
  TurnEvidence evidence;
  std::vector<float> log_weight;  // [cell], ln of the device's probability there, from the others
  std::vector<std::complex<double>> since;  // change of the factors since the evidence
  std::vector<double> gain;                 // [chain], amplitudes removed for the evidence
  // Model of a transmitter's known place; null: unknown place, candidates are in `evidence`.
  std::shared_ptr<const PlaceModel> known_place = nullptr;
  Vec3d place;  // [m], of known_place
};
// Model of a transmitter at a surveyed place [m].
std::shared_ptr<const PlaceModel> known_place_model(const AccessPointMap& map, const Vec3d& place);
// RememberedBurst::floor. REQUIRES: h, noise and evidence are set.
double burst_floor(const AccessPointMap& map,
                   const RememberedBurst& burst,
                   double likelihood_exponent);

// States nearer than this [rad] are the same state.
inline constexpr double kSameState = 0.7;
// [rad], maximum phase difference over the chains.
double distance(const std::vector<std::complex<double>>& a,
                const std::vector<std::complex<double>>& b);
std::vector<std::complex<double>> inverses(const std::vector<std::complex<double>>& factors);
// h: [chain][tone].
void multiply(const std::vector<std::complex<double>>& factors,
              std::vector<std::complex<double>>& h);
// A burst with these amplitudes of its chains removed, since RotationGrid has no amplitudes. h:
// [chain][tone]; noise: as ObservedArray::noise.
ObservedBurst without_gain(const AccessPointMap& map,
                           std::vector<std::complex<double>> h,
                           const std::vector<std::complex<double>>& gain,
                           double noise);

// Refines each start (a state relative to the accepted one) to its maximum and returns the results
// that differ, the best first. REQUIRES: starts and bursts not empty.
std::vector<ChainFactors> compare_states(const AccessPointMap& map,
                                         std::span<const RememberedBurst> received,
                                         std::span<const std::vector<std::complex<double>>> starts,
                                         double likelihood_exponent);

}  // namespace rayloc
