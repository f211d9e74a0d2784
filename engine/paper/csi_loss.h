// CsiLoss: distance of an expected from a measured channel, as in the paper's localization
// (METHODS A4): MSE of the smoothed amplitudes of antenna ratios + gamma_1 MSE of delays.
//
// The delays are spreads (DelaySpread) in nanoseconds: the paper does not state the unit of
// gamma_1, and in seconds they would have no weight. The caller supplies the expected channel: that
// of a moved device, or of a target.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"
#include "engine/observe/csi_ratio.h"
#include "engine/observe/savitzky_golay.h"
#include "engine/paper/delay_spread.h"

namespace rayloc::paper {

struct CsiLossOptions {
  double delay_weight = 0.05;  // gamma_1 [1/ns^2]
  SavitzkyGolayOptions smoothing = {};
  double floor = kRatioFloor;  // of RatioAmplitude and DelaySpread
};

class CsiLoss {
 public:
  // REQUIRES: as for RatioAmplitude and DelaySpread.
  CsiLoss(const OfdmGrid& grid, const CsiLossOptions& options);

  struct Observables {
    std::vector<double> amplitude;  // [antenna - 1][tone]
    std::vector<double> spread;     // [antenna] [s]
  };
  // `h`: [antenna][tone], at least two antennas, chain gains removed, with any factor and delay.
  Observables observe(std::span<const std::complex<double>> h) const;

  double value(const Observables& measured, const Observables& expected) const;

  // g with d value = Re sum conj(g) dh, where `expected` was computed from h.
  std::vector<std::complex<double>> adjoint(const Observables& measured,
                                            const Observables& expected,
                                            std::span<const std::complex<double>> h) const;

 private:
  RatioAmplitude amplitude_;
  DelaySpread spread_;
  double delay_weight_;  // [1/s^2]
};

}  // namespace rayloc::paper
