// RatioLikelihood: the likelihoods of ratios of adjacent antennas: ratio_complex and ratio_amp.
// Gain, phase and timing offset of a burst cancel on every tone; delays appear as changes from tone
// to tone.
//
// Both are compared on tones about 2.5 MHz apart: room echoes add no information in between.
//
// ratio_complex: z = h_m conj(h_{m+1}), scaled to |z| = 1 over all pairs and tones;
//                e^2 = |z - z'|^2.
// ratio_amp:     a as in RatioAmplitude; e^2 = sum (a - a')^2 relative to the best constant.
// Neither detects that a device is outside the room: every place is more likely than
// null_model().
//
// Ratios change within a fraction of the wavelength, and no average over a cell of the grid
// represents them: a cell holds the expected ratios at places a quarter of the wavelength apart,
// and its likelihood is the mean of theirs.
#pragma once

#include "engine/likelihood/likelihood.h"
#include "engine/observe/csi_ratio.h"
#include "engine/trace/cfr_kernel.h"

namespace rayloc {

class RatioLikelihood : public Likelihood {
 public:
  // REQUIRES: one of the two kinds, at least two antennas.
  RatioLikelihood(LikelihoodKind kind, const OfdmGrid& grid, std::size_t antennas);

  PlaceLikelihood place(const Place& place, const ModelError& error) const override;
  ObservedBurst observe(std::span<const std::complex<double>> h) const override;
  Coarse coarse(const PlaceLikelihood& place, const ObservedBurst& observed) const override;
  using Likelihood::log_likelihood;
  double log_likelihood(const PlaceLikelihood& place,
                        const ObservedBurst& observed,
                        std::uint8_t windows) const override;
  // Null: place() already evaluates the places of the cell.
  std::unique_ptr<const NearbyLikelihood> nearby(const Place& place,
                                                 const PlaceLikelihood& of,
                                                 const ModelError& error,
                                                 const ObservedBurst& observed) const override;
  PlaceLikelihood null_model(const ModelError& error) const override;

 private:
  std::vector<std::complex<float>> features(std::span<const std::complex<double>> h) const;
  std::vector<std::complex<double>> expected(const Place& place, const Vec3d& moved) const;
  double of_residual(double share) const;

  LikelihoodKind kind_;
  OfdmGrid grid_;
  std::size_t antennas_;
  ObservationModel model_;
  CfrKernel kernel_;
  RatioAmplitude amplitude_;
  std::vector<std::size_t> tones_;  // compared tones
  std::size_t feature_count_ = 0;
};

}  // namespace rayloc
