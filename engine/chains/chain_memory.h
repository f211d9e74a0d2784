// ChainMemory: accepted state of the receive chains of one access point, and the bursts from which
// it was learned.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/chains/chain_belief.h"
#include "engine/chains/chain_state.h"
#include "engine/chains/state_comparison.h"

namespace rayloc {

struct ChainMemory {
  // Counts of bursts, chosen.
  static constexpr std::size_t kMost = 48;      // remembered: a similar burst adds nothing new
  static constexpr std::size_t kMinBursts = 5;  // before the accepted state is given up
  static constexpr double kSure = 0.999;  // probability of the accepted state: nothing against it

  // rotated: the probability that the chains are not as calibrated, before the first burst.
  ChainMemory(std::size_t chains, double rotated);

  ChainState state;
  ChainBelief belief;
  std::vector<RememberedBurst> received;  // oldest first
  // Evidence of an earlier run; the first of its bursts are not yet evaluated, the others are the
  // first of `received`.
  std::shared_ptr<const ChainRecord> waiting;
  std::size_t unevaluated = 0;
  std::vector<std::complex<double>> gain;       // of the best state, relative to factors
  std::vector<std::complex<double>> favourite;  // factors of that state
  std::size_t unrefined = 0;                    // bursts since factors were refined or compared
  // Last evaluation for a burst unlike those remembered, and ChainBelief::probability() before it.
  std::optional<Timestamp> last_new;
  std::vector<double> before_new;
  Timestamp last;        // last evaluation for a device ...
  Timestamp last_fixed;  // ... and for a transmitter at a known place
  Timestamp last_sure;   // last time the accepted state was certain
  // Silences after which the chains may have changed, oldest first.
  struct Silence {
    Timestamp end;                // of the first frame afterwards
    std::vector<double> undoing;  // of the suspicion, as ChainBelief::suspect_for_now()
  };
  std::vector<Silence> silences;
  std::size_t harmless_silences = 0;  // those that left the chains as they were

  // True if the chains are known well enough to locate devices that others receive.
  bool is_known() const;
  // True if they are known well enough for infrequent evaluation.
  bool is_settled() const;

  void set_knowledge(ChainKnowledge knowledge, Timestamp time);
  // No frame was received for a while, until `end`: the access point may have been off.
  void suspect_after_silence(Timestamp end);
  // A burst repeats one of this time (of its last frame, of any access point), so the silences
  // since then left the chains as they were. Returns true if there were any.
  bool confirm_since(Timestamp time);
  // The bursts received since explain the accepted state best: confirms the chains after each
  // silence that kChainBurstsNeeded of them or more follow.
  void confirm_silences();
  // Remembered bursts since the last silence that kChainBurstsNeeded follow; since the oldest if
  // there is no such silence; all of them without any silence.
  std::span<const RememberedBurst> bursts_since_silence() const;
  // The silences until now left the chains as they were.
  void end_silences();
  // State 0 is certain: it is confirmed, or now denotes a newly accepted state.
  void settle();
  // The accepted state is given up. Bursts from before the oldest silence are forgotten.
  void give_up();
  // Drops the oldest burst when full.
  void remember(RememberedBurst burst);
  // Drops bursts from before last_sure: they contain no evidence on the present state.
  void forget_until_sure();
  // Multiplies the factors by these, a small correction; the accepted state stays.
  void correct(const ChainFactors& refined);
  // Multiplies the factors by these and accepts the result as the new state.
  void accept(const ChainFactors& refined);

 private:
  std::span<const RememberedBurst> bursts_since(const Silence& silence) const;
};

}  // namespace rayloc
