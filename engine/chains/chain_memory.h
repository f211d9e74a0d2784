// ChainMemory: what a learner believes of the receive chains of one access point, and the bursts
// that it rests on.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/chains/chain_belief.h"
#include "engine/chains/chain_state.h"
#include "engine/chains/state_comparison.h"

namespace rayloc {

struct ChainMemory {
  // Counts of bursts, chosen.
  static constexpr std::size_t kMost = 48;        // remembered: one like them tells nothing new
  static constexpr std::size_t kLeastBursts = 5;  // before anything is given up
  static constexpr double kSure = 0.999;  // a probability of what is believed: nothing against it

  // turned: the probability that the chains are not as calibrated, before the first burst.
  ChainMemory(std::size_t chains, double turned);

  ChainState state;
  ChainBelief belief;
  std::vector<RememberedBurst> heard;           // oldest first
  std::vector<std::complex<double>> level;      // of the state that explains most, beside factors
  std::vector<std::complex<double>> favourite;  // that state
  std::size_t unrefined = 0;                    // bursts since factors were refined or compared
  Timestamp last;                               // looked at for a device ...
  Timestamp last_fixed;                         // ... and for a transmitter at a known place
  Timestamp last_sure;                          // of what is believed

  // Well enough to say where a device is that others hear.
  bool is_known() const;
  // Well enough to look rarely.
  bool is_settled() const;

  void know(ChainKnowledge knowledge, Timestamp time);
  // The oldest burst makes room.
  void remember(RememberedBurst burst);
  // Those heard while what was believed was right say nothing of what is right now.
  void forget_until_sure();
  // The factors change by these: a little, and what is believed stays.
  void correct(const ChainFactors& refined);
  // The factors change by these, and that is believed now.
  void believe(const ChainFactors& refined);
};

}  // namespace rayloc
