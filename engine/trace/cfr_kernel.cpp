#include "engine/trace/cfr_kernel.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>

#include "engine/base/check.h"

// Highway compiles this file once for each kind of processor: the code between HWY_BEFORE_NAMESPACE
// and HWY_AFTER_NAMESPACE, into a separate namespace. There are no lambdas and no implicit
// constructors of vectors there: GCC gives them no wide instructions.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/trace/cfr_kernel.cpp"
#include <hwy/foreach_target.h>
// Follows foreach_target.h.
#include <hwy/highway.h>

#ifndef RAYLOC_CFR_KERNEL_ONCE
#define RAYLOC_CFR_KERNEL_ONCE
namespace rayloc {
namespace {

// A count, as cfr_kernel.h chooses it.
constexpr std::size_t kTonesPerBlock = CfrKernel::kTonesPerBlock;
// A count: tones to either side of a block's centre share a sine and cosine.
constexpr std::size_t kPairs = kTonesPerBlock / 2;
// Number of paths per tile: their tables fit in the first-level cache.
constexpr std::size_t kTilePaths = 128;
// A phasor is recomputed after this many rotations.
constexpr std::size_t kBlocksPerAnchor = 32;

struct ToneBlocks {
  double step_hz;
  std::span<const CfrKernel::Block> blocks;
  std::span<const std::uint8_t> position;

  bool turns_from_previous(std::size_t q) const {
    return blocks[q].follows_previous && q % kBlocksPerAnchor != 0;
  }
};

using Column = std::array<double, kTilePaths>;
struct ComplexColumn {
  Column re;
  Column im;
};

// At most kTilePaths paths, padded with zero-amplitude ones to whole pairs of vectors.
struct alignas(64) Tile {
  ComplexColumn a;
  Column tau;
  // exp(-j 2 pi kappa tau) = cos - j sin for the pairs of tones, kappa = (k + 1/2) step_hz.
  std::array<Column, kPairs> cos;
  std::array<Column, kPairs> sin;
  ComplexColumn turn;  // exp(-j 2 pi f tau) for f from one block to the next
  ComplexColumn b;     // a exp(-j 2 pi f tau) at the centre of the block
  std::size_t size;
};

// A pair of tones at centre +- kappa in the adjoint: sum w = even cos + odd sin, and weighted with
// the distance from the centre, sum +-kappa w = even_hz cos + odd_hz sin.
struct PairWeights {
  double even_re, even_im, odd_re, odd_im;
  double even_hz_re, even_hz_im, odd_hz_re, odd_hz_im;
};

}  // namespace
}  // namespace rayloc
#endif  // RAYLOC_CFR_KERNEL_ONCE

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Lanes are paths.
using Lanes = hn::ScalableTag<double>;
using Vector = hn::Vec<Lanes>;
constexpr Lanes kLanes;  // one path per lane of a vector register

struct ComplexVector {
  Vector re;
  Vector im;
};

HWY_INLINE Vector constant(double value) { return hn::Set(kLanes, value); }
HWY_INLINE ComplexVector zero() { return {hn::Zero(kLanes), hn::Zero(kLanes)}; }

HWY_INLINE Vector load(const Column& column, std::size_t i) { return hn::Load(kLanes, &column[i]); }
HWY_INLINE ComplexVector load(const ComplexColumn& column, std::size_t i) {
  return {load(column.re, i), load(column.im, i)};
}
HWY_INLINE void store(const ComplexVector& value, ComplexColumn& column, std::size_t i) {
  hn::Store(value.re, kLanes, &column.re[i]);
  hn::Store(value.im, kLanes, &column.im[i]);
}

HWY_INLINE ComplexVector multiply(const ComplexVector& x, const ComplexVector& y) {
  return {hn::NegMulAdd(x.im, y.im, hn::Mul(x.re, y.re)),
          hn::MulAdd(x.im, y.re, hn::Mul(x.re, y.im))};
}
HWY_INLINE ComplexVector plus_scaled(const ComplexVector& sum,
                                     const ComplexVector& x,
                                     Vector scale) {
  return {hn::MulAdd(x.re, scale, sum.re), hn::MulAdd(x.im, scale, sum.im)};
}
HWY_INLINE ComplexVector plus_product(const ComplexVector& sum,
                                      const ComplexVector& x,
                                      const ComplexVector& y) {
  return {hn::NegMulAdd(x.im, y.im, hn::MulAdd(x.re, y.re, sum.re)),
          hn::MulAdd(x.im, y.re, hn::MulAdd(x.re, y.im, sum.im))};
}

// exp(j 2 pi turns), within 1e-15. The Taylor series of a quarter of the angle, which lies within
// pi / 4, to the powers 15 and 16; then twice the double angle.
HWY_INLINE ComplexVector phasor(Vector turns) {
  const Vector part = hn::Sub(turns, hn::Round(turns));
  const Vector x = hn::Mul(part, constant(std::numbers::pi / 2));
  const Vector x2 = hn::Mul(x, x);
  Vector s = constant(-1.0 / 1307674368000.0);
  s = hn::MulAdd(s, x2, constant(1.0 / 6227020800.0));
  s = hn::MulAdd(s, x2, constant(-1.0 / 39916800.0));
  s = hn::MulAdd(s, x2, constant(1.0 / 362880.0));
  s = hn::MulAdd(s, x2, constant(-1.0 / 5040.0));
  s = hn::MulAdd(s, x2, constant(1.0 / 120.0));
  s = hn::MulAdd(s, x2, constant(-1.0 / 6.0));
  s = hn::MulAdd(hn::Mul(s, x2), x, x);
  Vector c = constant(1.0 / 20922789888000.0);
  c = hn::MulAdd(c, x2, constant(-1.0 / 87178291200.0));
  c = hn::MulAdd(c, x2, constant(1.0 / 479001600.0));
  c = hn::MulAdd(c, x2, constant(-1.0 / 3628800.0));
  c = hn::MulAdd(c, x2, constant(1.0 / 40320.0));
  c = hn::MulAdd(c, x2, constant(-1.0 / 720.0));
  c = hn::MulAdd(c, x2, constant(1.0 / 24.0));
  c = hn::MulAdd(c, x2, constant(-0.5));
  c = hn::MulAdd(c, x2, constant(1.0));
  const ComplexVector quarter{c, s};
  const ComplexVector half = multiply(quarter, quarter);
  return multiply(half, half);
}

// exp(-j 2 pi f tau).
HWY_INLINE ComplexVector delayed(double frequency_hz, Vector tau) {
  return phasor(hn::Mul(constant(-frequency_hz), tau));
}

// Fills the tile with the paths from `first` on, all fields except b.
void fill_tile(
    const PathArrays& paths, std::size_t first, std::size_t count, double step_hz, Tile& tile) {
  const std::size_t unit = 2 * hn::Lanes(kLanes);
  tile.size = (count + unit - 1) / unit * unit;
  for (std::size_t i = 0; i < tile.size; ++i) {
    const bool silent = i >= count;
    tile.a.re[i] = silent ? 0.0 : paths.a_re[first + i];
    tile.a.im[i] = silent ? 0.0 : paths.a_im[first + i];
    tile.tau[i] = silent ? 0.0 : paths.tau[first + i];
  }
  for (std::size_t i = 0; i < tile.size; i += hn::Lanes(kLanes)) {
    const Vector tau = load(tile.tau, i);
    store(delayed(step_hz * static_cast<double>(kTonesPerBlock), tau), tile.turn, i);
    ComplexVector pair = delayed(-0.5 * step_hz, tau);  // conjugate: cos + j sin
    const ComplexVector step = multiply(pair, pair);
    for (std::size_t k = 0; k < kPairs; ++k) {
      hn::Store(pair.re, kLanes, &tile.cos[k][i]);
      hn::Store(pair.im, kLanes, &tile.sin[k][i]);
      pair = multiply(pair, step);
    }
  }
}

// Stores the sums over all lanes of both.
#if HWY_TARGET == HWY_SCALAR  // one lane: nothing to add
HWY_INLINE void store_sum(Vector re, Vector im, double* out) {
  out[0] = hn::GetLane(re);
  out[1] = hn::GetLane(im);
}
#else
template <class D, class V>
HWY_INLINE void store_halves(D d, V re_im, double* out) {
  if constexpr (hn::MaxLanes(D()) > 2) {
    const hn::Half<D> half;
    store_halves(half, hn::Add(hn::LowerHalf(half, re_im), hn::UpperHalf(half, re_im)), out);
  } else {
    hn::StoreU(re_im, d, out);
  }
}

HWY_INLINE void store_sum(Vector re, Vector im, double* out) {
  store_halves(kLanes,
               hn::Add(hn::InterleaveLower(kLanes, re, im), hn::InterleaveUpper(kLanes, re, im)),
               out);
}
#endif

// The tones of one block, alternating real and imaginary parts.
using BlockTones = std::array<double, 2 * kTonesPerBlock>;

// h at the two tones of pair k, from even = sum b cos and odd = sum b sin: even -+ j odd.
HWY_INLINE void store_pair(const ComplexVector& even,
                           const ComplexVector& odd,
                           std::size_t k,
                           BlockTones& h) {
  const std::size_t above = kPairs + k;
  const std::size_t below = kPairs - 1 - k;
  store_sum(hn::Add(even.re, odd.im), hn::Sub(even.im, odd.re), &h[2 * above]);
  store_sum(hn::Sub(even.re, odd.im), hn::Add(even.im, odd.re), &h[2 * below]);
}

// Two pairs at a time: eight sums hide the latency of the multiply-adds and fit into sixteen
// registers.
HWY_INLINE void sum_block(const Tile& tile, BlockTones& h) {
  for (std::size_t k = 0; k < kPairs; k += 2) {
    ComplexVector even0 = zero();
    ComplexVector odd0 = zero();
    ComplexVector even1 = zero();
    ComplexVector odd1 = zero();
    for (std::size_t i = 0; i < tile.size; i += hn::Lanes(kLanes)) {
      const ComplexVector b = load(tile.b, i);
      even0 = plus_scaled(even0, b, load(tile.cos[k], i));
      odd0 = plus_scaled(odd0, b, load(tile.sin[k], i));
      even1 = plus_scaled(even1, b, load(tile.cos[k + 1], i));
      odd1 = plus_scaled(odd1, b, load(tile.sin[k + 1], i));
    }
    store_pair(even0, odd0, k, h);
    store_pair(even1, odd1, k + 1, h);
  }
}

// Moves b to the centre of block q.
HWY_INLINE void centre_tile(const ToneBlocks& tones, std::size_t q, Tile& tile) {
  const bool turn = tones.turns_from_previous(q);
  for (std::size_t i = 0; i < tile.size; i += hn::Lanes(kLanes)) {
    const ComplexVector b =
        turn ? multiply(load(tile.b, i), load(tile.turn, i))
             : multiply(load(tile.a, i), delayed(tones.blocks[q].centre_hz, load(tile.tau, i)));
    store(b, tile.b, i);
  }
}

// Adds the contribution of the tile's paths to h.
void add_tile(const ToneBlocks& tones, Tile& tile, std::span<std::complex<double>> h) {
  for (std::size_t q = 0; q < tones.blocks.size(); ++q) {
    centre_tile(tones, q, tile);
    BlockTones sums;
    sum_block(tile, sums);
    const CfrKernel::Block& block = tones.blocks[q];
    for (std::size_t j = block.first_tone; j < block.first_tone + block.num_tones; ++j) {
      const std::size_t at = 2 * std::size_t{tones.position[j]};
      h[j] += std::complex<double>(sums[at], sums[at + 1]);
    }
  }
}

// The adjoint sums of one block relative to its centre, or of all blocks in absolute terms, for one
// vector of paths: plain, and times the frequency.
struct AdjointSums {
  ComplexVector s0;
  ComplexVector s1;
};

HWY_INLINE void add_pair(const PairWeights& w, Vector cos, Vector sin, AdjointSums& sums) {
  sums.s0 = plus_scaled(sums.s0, {constant(w.even_re), constant(w.even_im)}, cos);
  sums.s1 = plus_scaled(sums.s1, {constant(w.even_hz_re), constant(w.even_hz_im)}, cos);
  sums.s0 = plus_scaled(sums.s0, {constant(w.odd_re), constant(w.odd_im)}, sin);
  sums.s1 = plus_scaled(sums.s1, {constant(w.odd_hz_re), constant(w.odd_hz_im)}, sin);
}

HWY_INLINE void add_block(const AdjointSums& block,
                          double centre_hz,
                          const ComplexVector& centre,
                          AdjointSums& sums) {
  sums.s0 = plus_product(sums.s0, centre, block.s0);
  sums.s1 = plus_product(sums.s1, centre, plus_scaled(block.s1, block.s0, constant(centre_hz)));
}

struct AdjointColumns {
  Column a_re;
  Column a_im;
  Column tau;
};

HWY_INLINE void store_adjoint(const AdjointSums& sums,
                              const Tile& tile,
                              std::size_t i,
                              AdjointColumns& out) {
  const ComplexVector a_s1 = multiply(load(tile.a, i), sums.s1);
  hn::Store(sums.s0.re, kLanes, &out.a_re[i]);
  hn::Store(hn::Neg(sums.s0.im), kLanes, &out.a_im[i]);
  hn::Store(hn::Mul(a_s1.im, constant(2.0 * std::numbers::pi)), kLanes, &out.tau[i]);
}

// The adjoints of the paths of the tile; `weights`: kPairs for each block. Two vectors of paths at
// a time: eight sums, and each weight is used twice.
void tile_adjoint(const ToneBlocks& tones,
                  std::span<const PairWeights> weights,
                  const Tile& tile,
                  AdjointColumns& out) {
  const std::size_t width = hn::Lanes(kLanes);
  for (std::size_t i = 0; i < tile.size; i += 2 * width) {
    ComplexVector left_centre = zero();
    ComplexVector right_centre = zero();
    AdjointSums left{zero(), zero()};
    AdjointSums right{zero(), zero()};
    for (std::size_t q = 0; q < tones.blocks.size(); ++q) {
      const double centre_hz = tones.blocks[q].centre_hz;
      if (tones.turns_from_previous(q)) {
        left_centre = multiply(left_centre, load(tile.turn, i));
        right_centre = multiply(right_centre, load(tile.turn, i + width));
      } else {
        left_centre = delayed(centre_hz, load(tile.tau, i));
        right_centre = delayed(centre_hz, load(tile.tau, i + width));
      }
      AdjointSums left_block{zero(), zero()};
      AdjointSums right_block{zero(), zero()};
      for (std::size_t k = 0; k < kPairs; ++k) {
        const PairWeights& w = weights[q * kPairs + k];
        add_pair(w, load(tile.cos[k], i), load(tile.sin[k], i), left_block);
        add_pair(w, load(tile.cos[k], i + width), load(tile.sin[k], i + width), right_block);
      }
      add_block(left_block, centre_hz, left_centre, left);
      add_block(right_block, centre_hz, right_centre, right);
    }
    store_adjoint(left, tile, i, out);
    store_adjoint(right, tile, i + width, out);
  }
}

void forward(const ToneBlocks& tones, const PathArrays& paths, std::span<std::complex<double>> h) {
  Tile tile;
  const std::size_t num_paths = paths.tau.size();
  for (std::size_t first = 0; first < num_paths; first += kTilePaths) {
    fill_tile(paths, first, std::min(kTilePaths, num_paths - first), tones.step_hz, tile);
    add_tile(tones, tile, h);
  }
}

void adjoint(const ToneBlocks& tones,
             const PathArrays& paths,
             std::span<const PairWeights> weights,
             PathAdjoints& out) {
  Tile tile;
  alignas(64) AdjointColumns columns;
  const std::size_t num_paths = paths.tau.size();
  for (std::size_t first = 0; first < num_paths; first += kTilePaths) {
    const std::size_t count = std::min(kTilePaths, num_paths - first);
    fill_tile(paths, first, count, tones.step_hz, tile);
    tile_adjoint(tones, weights, tile, columns);
    for (std::size_t i = 0; i < count; ++i) {
      out.a_re[first + i] = columns.a_re[i];
      out.a_im[first + i] = columns.a_im[i];
      out.tau[first + i] = columns.tau[i];
    }
  }
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc {
namespace {

HWY_EXPORT(forward);
HWY_EXPORT(adjoint);

bool of_one_size(const PathArrays& paths) {
  return paths.a_re.size() == paths.tau.size() && paths.a_im.size() == paths.tau.size();
}

// The largest step that divides the distances between all neighbouring tones.
int tone_step(const OfdmGrid& grid) {
  int step = 0;
  for (std::size_t j = 1; j < grid.size(); ++j) {
    step = std::gcd(step, grid.tone_index[j] - grid.tone_index[j - 1]);
  }
  return std::max(step, 1);
}

// Weights of above exp(-j 2 pi kappa tau) + below exp(j 2 pi kappa tau). Written out, since a
// product of two std::complex checks for infinities.
PairWeights pair_weights(const std::complex<double>& below,
                         const std::complex<double>& above,
                         double kappa_hz) {
  const std::complex<double> sum = above + below;
  const std::complex<double> difference = above - below;
  return {sum.real(),
          sum.imag(),
          difference.imag(),
          -difference.real(),
          kappa_hz * difference.real(),
          kappa_hz * difference.imag(),
          kappa_hz * sum.imag(),
          -kappa_hz * sum.real()};
}

}  // namespace

CfrKernel::CfrKernel(const OfdmGrid& grid) : position_(grid.size()) {
  const int step = tone_step(grid);
  const int width = step * static_cast<int>(kTonesPerBlock);
  step_hz_ = grid.spacing_hz * step;
  int lowest = 0;  // index of the block's first tone
  for (std::size_t j = 0; j < grid.size(); ++j) {
    const int index = grid.tone_index[j];
    if (blocks_.empty() || index >= lowest + width) {
      const bool follows = !blocks_.empty() && index == lowest + width;
      const double middle = index + 0.5 * (width - step);
      blocks_.push_back({grid.centre_hz + middle * grid.spacing_hz, follows, j, 0});
      lowest = index;
    }
    position_[j] = static_cast<std::uint8_t>((index - lowest) / step);
    ++blocks_.back().num_tones;
  }
}

void CfrKernel::forward(const PathArrays& paths, std::span<std::complex<double>> h) const {
  RAYLOC_CHECK(of_one_size(paths) && h.size() == num_tones());
  std::fill(h.begin(), h.end(), std::complex<double>{});
  HWY_DYNAMIC_DISPATCH(forward)({step_hz_, blocks_, position_}, paths, h);
}

PathAdjoints CfrKernel::adjoint(const PathArrays& paths,
                                std::span<const std::complex<double>> g) const {
  RAYLOC_CHECK(of_one_size(paths) && g.size() == num_tones());
  std::vector<PairWeights> weights;
  weights.reserve(blocks_.size() * kPairs);
  for (const Block& block : blocks_) {
    std::array<std::complex<double>, kTonesPerBlock> w{};
    for (std::size_t j = block.first_tone; j < block.first_tone + block.num_tones; ++j) {
      w[position_[j]] = std::conj(g[j]);
    }
    for (std::size_t k = 0; k < kPairs; ++k) {
      const double kappa_hz = (static_cast<double>(k) + 0.5) * step_hz_;
      weights.push_back(pair_weights(w[kPairs - 1 - k], w[kPairs + k], kappa_hz));
    }
  }
  const std::size_t num_paths = paths.tau.size();
  PathAdjoints out{std::vector<double>(num_paths),
                   std::vector<double>(num_paths),
                   std::vector<double>(num_paths)};
  HWY_DYNAMIC_DISPATCH(adjoint)({step_hz_, blocks_, position_}, paths, weights, out);
  return out;
}

}  // namespace rayloc
#endif  // HWY_ONCE
