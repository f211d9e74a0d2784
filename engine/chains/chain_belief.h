// ChainBelief: probability of every state of the receive chains of one access point (phase offsets
// relative to the accepted state, state 0), updated with one burst after the other.
//
// A burst may match no place, or the chains may change before the next burst. The evidence of one
// burst is therefore bounded and every state keeps a small probability, so a wrong belief is given
// up after about as many bursts as it took to form.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/rotated_likelihood.h"

namespace rayloc {

class ChainBelief {
 public:
  static constexpr double kMaxOfBurst = 4.0;  // [nat], per burst: the burst may match no place

  // rotated: prior probability that the chains differ from the accepted state.
  ChainBelief(std::size_t chains, double rotated);

  const RotationGrid& grid() const { return grid_; }

  // log_evidence: [state], from turn_evidence().
  void receive(std::span<const double> log_evidence);
  // The chains may have changed, with this probability: a power cycle is likely.
  void suspect(double probability);
  // As suspect(). Returns what undoes it, also after further evidence: a factor of each state.
  std::vector<double> suspect_for_now(double probability);
  // Multiplies the probability of each state by a factor, [state].
  void multiply(std::span<const double> factor);
  // The accepted state has changed: state 0 now denotes the new one.
  void settle();
  // Continues from the probabilities of an earlier run, [state]. REQUIRES: grid().size() values.
  void resume(std::span<const double> probability);

  // Probability of a state and those near it.
  double near(std::size_t state) const;
  double as_accepted() const { return near(0); }
  // The most probable states that are not near each other, in descending order of probability.
  std::vector<std::size_t> modes(std::size_t most) const;
  const std::vector<double>& probability() const { return probability_; }  // [state]

 private:
  bool is_near(std::size_t a, std::size_t b) const;

  RotationGrid grid_;
  std::vector<double> probability_;
};

}  // namespace rayloc
