// CfrKernel: the channel frequency response of many paths on the tones of one grid,
//
//   h_j = sum_p a_p exp(-j 2 pi f_j tau_p),
//
// and its adjoint, which carries derivatives of a loss by h back to a and tau.
//
// The widest vectors of the processor are used, selected at run time. The result does not depend on
// threads; between kinds of processors it differs by less than 1e-12 of the largest |h|, since
// fused multiply-adds and the order of a sum's lanes differ.
//
// Error: below 1e-11 of sum_p |a_p|, for delays to 1 us at carriers to 7 GHz, from the rounding of
// f tau to a double.
//
// Method. The tones are processed in blocks of 16 neighbours around a centre f_q, with b = a exp(-j
// 2 pi f_q tau) rotated by one complex factor from block to block. The tones at f_q +- kappa share
// sum b cos(2 pi kappa tau) and sum b sin(2 pi kappa tau): two real multiply-adds per path and
// tone, where the definition takes four. Missing tones inside a block cost as much.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"

namespace rayloc {

// Coefficient and delay [s] of each path, as in `Path`. All arrays have one size.
struct PathArrays {
  std::span<const double> a_re;
  std::span<const double> a_im;
  std::span<const double> tau;
};

// Sensitivity of a real loss L to the paths: dL = sum_p Re(conj(a_p~) da_p) + tau_p~ dtau_p, that
// is re~ dre + im~ dim + tau~ dtau for each path.
struct PathAdjoints {
  std::vector<double> a_re;
  std::vector<double> a_im;
  std::vector<double> tau;  // [1/s]
};

class CfrKernel {
 public:
  explicit CfrKernel(const OfdmGrid& grid);

  std::size_t num_tones() const { return position_.size(); }

  // h_j of all tones. REQUIRES: arrays of one size, h.size() == num_tones().
  void forward(const PathArrays& paths, std::span<std::complex<double>> h) const;

  // From g, with dL = Re sum_j conj(g_j) dh_j (for L = sum |h_j - m_j|^2 that is g = 2 (h - m)):
  //   a~   = conj(S0),         S0 = sum_j conj(g_j) exp(-j 2 pi f_j tau),
  //   tau~ = 2 pi Im(a S1),    S1 = sum_j conj(g_j) f_j exp(-j 2 pi f_j tau).
  // REQUIRES: arrays of one size, g.size() == num_tones().
  PathAdjoints adjoint(const PathArrays& paths, std::span<const std::complex<double>> g) const;

  // Tones first_tone, ... (num_tones of them) lie within kTonesPerBlock steps around centre_hz.
  struct Block {
    double centre_hz = 0.0;
    bool follows_previous = false;  // its centre is one block's width above the previous one
    std::size_t first_tone = 0;
    std::size_t num_tones = 0;
  };
  // A count, chosen: that many sines fit in the first-level cache.
  static constexpr std::size_t kTonesPerBlock = 16;

 private:
  double step_hz_ = 0.0;                // between neighbours within a block
  std::vector<Block> blocks_;           // ascending
  std::vector<std::uint8_t> position_;  // of each tone in its block, 0 the lowest
};

}  // namespace rayloc
