// ChainBelief: how probable every state of the receive chains of one access point is, turned
// against what is believed of them (state 0), from one burst after the other.
//
// Any burst may be of no place, or chains may turn before the next: what one burst can say is
// bounded, and every state keeps a small probability. So a belief that has become wrong is given up
// after about as many bursts as it took to form it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/turned_likelihood.h"

namespace rayloc {

class ChainBelief {
 public:
  static constexpr double kMostOfBurst = 4.0;  // [nat], of one burst: it may be of no place

  // turned: the probability that chains are not as believed, before the first burst.
  ChainBelief(std::size_t chains, double turned);

  const TurnGrid& grid() const { return grid_; }

  // log_evidence: [state], turn_evidence().
  void hear(std::span<const double> log_evidence);
  // Chains may have turned, with this probability: a power cycle is likely.
  void doubt(double probability);
  // What is believed has changed: state 0 is another one now.
  void settle();

  // Of a state and those near it.
  double near(std::size_t state) const;
  double as_believed() const { return near(0); }
  // The most probable states that are not near each other, the most probable first.
  std::vector<std::size_t> modes(std::size_t most) const;
  const std::vector<double>& probability() const { return probability_; }  // [state]

 private:
  bool is_near(std::size_t a, std::size_t b) const;

  TurnGrid grid_;
  std::vector<double> probability_;
};

}  // namespace rayloc
