// Likelihood of a burst at a place (ObservationModel) for receive chains with phase offsets: for
// all states of a grid at once, and for any factors of the chains, from ChainProducts.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/likelihood/chain_kernel.h"
#include "engine/likelihood/observed_array.h"
#include "engine/likelihood/place_model.h"

namespace rayloc {

// States of the chains: each but the first rotated relative to it by a multiple of a step.
class RotationGrid {
 public:
  explicit RotationGrid(std::size_t chains);  // REQUIRES: 1 to kMaxChains

  std::size_t chains() const { return chains_; }
  std::size_t size() const { return size_; }
  double step() const;  // [rad]
  // [step], phase offset of a chain in a state, from 0 on.
  std::size_t turn(std::size_t state, std::size_t chain) const;
  double phase(std::size_t state, std::size_t chain) const;  // [rad], -pi to pi
  // [step], largest difference of a chain between two states.
  std::size_t distance(std::size_t a, std::size_t b) const;
  std::span<const std::complex<float>> undoing() const { return undoing_; }  // [turn]

 private:
  std::size_t chains_;
  std::size_t size_ = 1;
  std::vector<std::complex<float>> undoing_;
};

// Sets of_state[s] to the coarse log-likelihood with the chains in state s, each but the first
// rotated by one of `undoing` (as of a RotationGrid); the windows are those that may hold the best
// delay of any state.
std::uint8_t coarse_of_turns(const PlaceModel& place,
                             const ObservedArray& observed,
                             std::size_t chains,
                             std::span<const std::complex<float>> undoing,
                             std::span<float> of_state);
// The same over these windows, without a parabola between the delays.
void log_likelihood_of_turns(const PlaceModel& place,
                             const ObservedArray& observed,
                             std::uint8_t windows,
                             const RotationGrid& grid,
                             std::span<float> of_state);

// Terms of a burst at a place and the best-fitting delay, for any factors of the chains.
struct ChainMoments {
  struct Mean {
    std::array<std::complex<double>, kMaxChains> along{};
    double offset = 0.0;
  };
  std::size_t chains = 0;
  double dimension = 0.0;
  std::array<double, kMaxChains> power{};
  std::array<std::complex<double>, kChainPairs> cross{};
  std::array<Mean, 2> means{};
  std::size_t mean_count = 0;

  // undoing: [chain], the inverses of the chains' factors.
  double log_likelihood(std::span<const std::complex<double>> undoing) const;
  // For the burst with each chain multiplied by its factor; up to a constant of the factors.
  ChainMoments multiplied(std::span<const std::complex<double>> factor) const;
};
ChainMoments chain_moments(const PlaceModel& place,
                           const ObservedArray& observed,
                           std::span<const std::complex<double>> undoing);

}  // namespace rayloc
