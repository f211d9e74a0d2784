// Delay: the delays compared by the paper's calibration, for every antenna and tone.
//
// A frame's timing offset is random, so the delay of a tone cannot be observed; differences of
// group delays can (METHODS C3). The device's position is given, and with it the line of sight. It
// is removed from the channel, s = h exp(+j 2 pi f tau_los), and the remaining phase slope is the
// excess delay:
//
//   c_k    = s_{k+1} conj(s_k), smoothed along the tones (neighbours only, no pair across a gap)
//   g_k    = -arg(c_k + floor P) / (2 pi (f_{k+1} - f_k))       P: mean square of the antenna
//   delay  = tau_los + g_k - sum of w g over antennas and tones
//
// The mean, with the measured |c| as the weights w in both channels, removes the part that the
// timing offset makes unobservable; adding tau_los sets the scale of the relative error of a SMAPE.
// With the floor, the slope at a null, which is arbitrary, tends to that of the line of sight.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"
#include "engine/observe/savitzky_golay.h"

namespace rayloc::paper {

class Delay {
 public:
  // REQUIRES: valid options, floor > 0, at least two tones.
  Delay(const OfdmGrid& grid, const SavitzkyGolayOptions& smoothing, double floor);

  // The delay of the line of sight from the device to each antenna [s], and the weights of the
  // mean, [antenna][pair of tones], with a sum of 1.
  struct Anchor {
    std::vector<double> line_of_sight;
    std::vector<double> weight;
  };
  // `measured`: [antenna][tone], chain gains removed, with a timing offset of a few ns at most.
  Anchor anchor(std::span<const std::complex<double>> measured,
                std::vector<double> line_of_sight) const;

  // [antenna][pair of tones] [s]. REQUIRES: h has the tones of the grid for each antenna.
  std::vector<double> of(std::span<const std::complex<double>> h, const Anchor& anchor) const;

  // From dL / d(delay) [1/s], g with dL = Re sum conj(g) dh.
  std::vector<std::complex<double>> adjoint(std::span<const std::complex<double>> h,
                                            const Anchor& anchor,
                                            std::span<const double> delay_adjoint) const;

 private:
  using Values = std::vector<std::complex<double>>;
  // For one antenna.
  Values without_line_of_sight(std::span<const std::complex<double>> row, double delay) const;
  Values smooth_products(std::span<const std::complex<double>> s) const;
  double least(std::span<const std::complex<double>> row) const;

  OfdmGrid grid_;
  double floor_;
  std::vector<std::size_t> lower_;  // tone of each pair; the other one is the next
  double slope_ = 0.0;              // [s/rad], -1 / (2 pi (f_{k+1} - f_k))
  SavitzkyGolay smoother_;
};

}  // namespace rayloc::paper
