// ChainRecord: evidence on the receive chains of one access point that are being learned, for a
// program that continues to learn them.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"

namespace rayloc {

class AccessPointMap;
struct ChainMemory;

// Relative to ChainState::factors, with which it is stored.
struct ChainRecord {
  struct Burst {
    std::vector<std::complex<double>> h;  // [chain][tone], factors removed
    Timestamp time;
    double noise = 0.0;
    std::vector<double> gain;       // [chain], amplitudes removed for the evidence
    std::vector<float> log_weight;  // [cell], as in RememberedBurst; empty: any cell
    std::optional<Vec3d> place;     // [m], of a transmitter at a known place
  };
  std::vector<double> belief;                   // [state], ChainBelief::probability()
  std::vector<Burst> received;                  // oldest first, at most ChainMemory::kMost
  std::vector<double> gain;                     // [chain], ChainMemory::gain
  std::vector<std::complex<double>> favourite;  // [chain], or empty: ChainMemory::favourite
  std::size_t unrefined = 0;                    // ChainMemory::unrefined
  // ChainState, of the learner with this evidence.
  std::size_t bursts = 0;
  std::size_t bursts_needed = 0;
  double lead = 0.0;         // [nat], ChainState::evidence
  double phase_sigma = 0.0;  // [rad]
  // The learner with this evidence: its number, and the number of learners in its program. Each
  // learner has its own device model, so evidence of another number is not comparable.
  std::size_t learner = 0;
  std::size_t learners = 1;
};

// The evidence in `ap`; empty if there is none, or if its chains are not being learned.
std::optional<ChainRecord> record_of(const ChainMemory& ap);

// Continues from the record in ap.state, which it takes. The bursts wait for evaluate_waiting().
// REQUIRES: the sizes of its arrays are those of the access point.
void resume(ChainMemory& ap);

// Bursts per call of evaluate_waiting(), chosen: some milliseconds of a core each. All of them at
// once would delay live bursts until they are dropped.
inline constexpr std::size_t kEvaluatedAtOnce = 8;

// Evaluates the latest of the waiting bursts. Weights of another number of cells are replaced by
// equal ones. REQUIRES: the map has all antennas of the access point.
void evaluate_waiting(const AccessPointMap& map, double likelihood_exponent, ChainMemory& ap);

}  // namespace rayloc
