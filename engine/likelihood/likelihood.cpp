#include "engine/likelihood/likelihood.h"

#include <algorithm>
#include <array>

#include "engine/base/check.h"
#include "engine/likelihood/gaussian_likelihood.h"
#include "engine/likelihood/ratio_likelihood.h"

namespace rayloc {
namespace {

// The likelihoods of METHODS B2.
constexpr std::array<LikelihoodName, 5> kNames{{
    {LikelihoodKind::kPartial, "partial", "every path has a known and an unknown part"},
    {LikelihoodKind::kCoherent, "coherent", "every path is known, phase and strength"},
    {LikelihoodKind::kPathCovariance,
     "path_covariance",
     "phases unknown; directions, relative delays and powers known"},
    {LikelihoodKind::kRatioComplex,
     "ratio_complex",
     "complex ratios of adjacent antennas, as normalised products"},
    {LikelihoodKind::kRatioAmplitude,
     "ratio_amp",
     "amplitudes of the ratios of adjacent antennas, as the paper has them"},
}};

}  // namespace

std::span<const LikelihoodName> likelihood_names() { return kNames; }

LikelihoodKind likelihood_of(std::string_view name) {
  const auto* const found = std::find_if(
      kNames.begin(), kNames.end(), [&](const LikelihoodName& one) { return one.name == name; });
  RAYLOC_CHECK(found != kNames.end());
  return found->kind;
}

bool compares_antennas(LikelihoodKind kind) {
  return kind == LikelihoodKind::kRatioComplex || kind == LikelihoodKind::kRatioAmplitude;
}

PlaceLikelihood Likelihood::column(std::span<const WeightedPlace> /*heights*/,
                                   const ModelError& /*error*/) const {
  RAYLOC_CHECK(false);
  return {};
}

PlaceLikelihood Likelihood::close(const Place& /*place*/, const ModelError& /*error*/) const {
  return {};
}

std::unique_ptr<const Likelihood> Likelihood::make(LikelihoodKind kind,
                                                   const OfdmGrid& grid,
                                                   std::size_t antennas) {
  if (compares_antennas(kind)) {
    return std::make_unique<RatioLikelihood>(kind, grid, antennas);
  }
  return std::make_unique<GaussianLikelihood>(kind, grid, antennas);
}

}  // namespace rayloc
