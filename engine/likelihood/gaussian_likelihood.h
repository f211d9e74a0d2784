// GaussianLikelihood: the likelihoods based on ObservationModel: partial, coherent and
// path_covariance. They differ in how much of a ray's mean is known (PathKnowledge).
#pragma once

#include "engine/likelihood/likelihood.h"

namespace rayloc {

class GaussianLikelihood : public Likelihood {
 public:
  // REQUIRES: one of the three kinds.
  GaussianLikelihood(LikelihoodKind kind, const OfdmGrid& grid, std::size_t antennas);

  PlaceLikelihood place(const Place& place, const ModelError& error) const override;
  PlaceLikelihood close(const Place& place, const ModelError& error) const override;
  PlaceLikelihood column(std::span<const WeightedPlace> heights,
                         const ModelError& error) const override;
  ObservedBurst observe(std::span<const std::complex<double>> h) const override;
  Coarse coarse(const PlaceLikelihood& place, const ObservedBurst& observed) const override;
  using Likelihood::log_likelihood;
  double log_likelihood(const PlaceLikelihood& place,
                        const ObservedBurst& observed,
                        std::uint8_t windows) const override;
  std::unique_ptr<const NearbyLikelihood> nearby(const Place& place,
                                                 const PlaceLikelihood& of,
                                                 const ModelError& error,
                                                 const ObservedBurst& observed) const override;
  PlaceLikelihood null_model(const ModelError& error) const override;

 private:
  Place sharp(Place place) const;

  LikelihoodKind kind_;
  ObservationModel model_;
};

}  // namespace rayloc
