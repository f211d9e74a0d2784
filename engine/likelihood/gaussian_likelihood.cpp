#include "engine/likelihood/gaussian_likelihood.h"

#include <algorithm>
#include <numbers>

#include "engine/base/check.h"
#include "engine/likelihood/burst_noise.h"

namespace rayloc {
namespace {

PathKnowledge knowledge_of(LikelihoodKind kind) {
  switch (kind) {
    case LikelihoodKind::kCoherent:
      return PathKnowledge::kFull;
    case LikelihoodKind::kPathCovariance:
      return PathKnowledge::kPower;
    default:
      RAYLOC_CHECK(kind == LikelihoodKind::kPartial);
      return PathKnowledge::kPartial;
  }
}

}  // namespace

GaussianLikelihood::GaussianLikelihood(LikelihoodKind kind,
                                       const OfdmGrid& grid,
                                       std::size_t antennas)
    : kind_(kind), model_(grid, antennas, knowledge_of(kind)) {}

PlaceLikelihood GaussianLikelihood::place(const Place& place, const ModelError& error) const {
  PlaceLikelihood result;
  result.model = model_.place(place, error);
  result.reachable = result.model.reachable;
  return result;
}

PlaceLikelihood GaussianLikelihood::close(const Place& place, const ModelError& error) const {
  PlaceLikelihood result;
  if (kind_ != LikelihoodKind::kPathCovariance) {
    result.sharp = model_.place(sharp(place), error);
  }
  return result;
}

PlaceLikelihood GaussianLikelihood::column(std::span<const WeightedPlace> heights,
                                           const ModelError& error) const {
  PlaceLikelihood result;
  result.model = model_.column(heights, error);
  result.reachable = result.model.reachable;
  return result;
}

ObservedBurst GaussianLikelihood::observe(std::span<const std::complex<double>> h) const {
  return {model_.observe(h), {}, 0.0F};
}

Likelihood::Coarse GaussianLikelihood::coarse(const PlaceLikelihood& place,
                                              const ObservedBurst& observed) const {
  return ObservationModel::coarse(place.model, observed.array);
}

double GaussianLikelihood::log_likelihood(const PlaceLikelihood& place,
                                          const ObservedBurst& observed,
                                          std::uint8_t windows) const {
  return ObservationModel::log_likelihood(place.model, observed.array, windows);
}

std::unique_ptr<const NearbyLikelihood> GaussianLikelihood::nearby(
    const Place& place,
    const PlaceLikelihood& of,
    const ModelError& error,
    const ObservedBurst& observed) const {
  if (kind_ == LikelihoodKind::kPathCovariance) {
    return nullptr;  // without phases, offsets of centimetres have no effect
  }
  const Place middle = sharp(place);
  if (!lacks_noise(of.sharp, observed.array)) {
    return std::make_unique<const NearbyLikelihood>(
        model_, middle, error, of.sharp, observed.array);
  }
  return std::make_unique<const NearbyLikelihood>(
      model_,
      middle,
      error,
      std::make_unique<const PlaceModel>(model_.place_of_burst(middle, error, observed.array)),
      observed.array);
}

// Place model of a device within half the place distance of the cell's centre.
Likelihood::Place GaussianLikelihood::sharp(Place place) const {
  const double wavelength = 2.0 * std::numbers::pi / model_.wave_number();
  place.cell_size = std::min(place.cell_size, NearbyLikelihood::kPlaceDistance * wavelength);
  place.cell_height = std::min(place.cell_height, NearbyLikelihood::kHeightDistance * wavelength);
  return place;
}

PlaceLikelihood GaussianLikelihood::null_model(const ModelError& error) const {
  PlaceLikelihood result;
  result.model = model_.null_model(error);
  return result;
}

}  // namespace rayloc
