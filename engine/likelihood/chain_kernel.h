// ChainKernel: whitens a burst chain by chain and computes its likelihood for all phase offsets of
// the receive chains, eight delays at a time.
//
// W y is a sum over the chains, W y = sum_m W_m y_m. With u_m = W_m y_m and z_m the factor that
// corrects a chain's phase offset,
//
//   |W y|^2 = sum_mn conj(z_m) z_n u_m^H u_n,     (W mu)^H W y = sum_m z_m (W mu)^H u_m,
//
// so the products of the u_m are computed once, at the cost of one whitening, and every state of
// the chains takes a few more multiplications. The result does not depend on the number of threads;
// it differs by rounding between kinds of processors.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>

#include "engine/likelihood/lane_kernel.h"

namespace rayloc {

inline constexpr std::size_t kMaxChains = 4;  // a count: of the radios that have a decoder
// A count: pairs of two chains.
inline constexpr std::size_t kChainPairs = kMaxChains * (kMaxChains - 1) / 2;

constexpr std::size_t chain_pair(std::size_t m, std::size_t n) {  // m < n
  return n * (n - 1) / 2 + m;
}

struct ChainProducts {
  std::array<LaneRow, kMaxChains> power{};                  // |u_m|^2
  std::array<LaneSums, kChainPairs> cross{};                // [chain_pair(m, n)] u_m^H u_n
  std::array<std::array<LaneSums, kMaxChains>, 2> along{};  // [mean][m], (W mu)^H u_m
};

// x is [coordinate], one chain after another; `means` [mean][coordinate], at most two. REQUIRES:
// chains <= kMaxChains, divides re.size() == im.size().
ChainProducts whiten_chains(const std::complex<float>* whitener,
                            std::span<const LaneRow> re,
                            std::span<const LaneRow> im,
                            std::span<const std::complex<float>> means,
                            std::size_t chains);

// Parameters of the evaluation at one place.
struct TurnQuestion {
  std::size_t chains = 0;
  std::size_t dimension = 0;                   // of the observation
  std::size_t mean = 0;                        // index in ChainProducts::along
  float offset = 0.0F;                         // added to every value
  std::span<const std::complex<float>> turns;  // phasors that each chain but the first may take
};

// 2 D ln r - r^2 a + 2 r |b| at its maximum over r, for every state of the chains: the first
// unrotated, the others each rotated by each of `turns`, the last chain fastest. best[state] is
// raised to the value at the best delay; highest: the best state at each delay. REQUIRES:
// best.size() == turns.size() ^ (chains - 1).
void best_of_turns(const ChainProducts& products,
                   const TurnQuestion& question,
                   std::span<float> best,
                   LaneRow& highest);

}  // namespace rayloc
