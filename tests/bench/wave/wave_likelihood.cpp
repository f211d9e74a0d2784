#include "tests/bench/wave/wave_likelihood.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Core>

#include "engine/likelihood/place_moments.h"

namespace rayloc::bench {
namespace {

using Value = std::complex<double>;
using Eigen::Index;

const std::vector<EdgeRay>& added_rays(const WavePlace& place, const WaveVariant& variant) {
  return variant.deeper ? place.deeper : place.edges;
}

// The rays and those over edges, weaker by the variant's amplitude.
std::vector<Ray> all_rays(const WavePlace& place, const WaveVariant& variant) {
  std::vector<Ray> rays = place.rays;
  if (variant.edge_amplitude > 0.0) {
    const std::vector<EdgeRay>& added = added_rays(place, variant);
    rays.reserve(rays.size() + added.size());
    for (const EdgeRay& edge : added) {
      rays.push_back(edge.ray);
      rays.back().amplitude *= variant.edge_amplitude;
    }
  }
  return rays;
}

}  // namespace

WaveLikelihood::WaveLikelihood(const OfdmGrid& grid,
                               const RoomAccessPoint& access_point,
                               double survey_sigma)
    : model_(grid, access_point.rx_chains.size()),
      basis_(grid),
      offsets_(offsets_of(access_point.array)),
      survey_sigma_(survey_sigma) {
  std::vector<Value> tone(basis_.size());
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    basis_.tone((static_cast<double>(bin) + 0.5) * kBin, tone);
    const Eigen::Map<const Eigen::VectorXcd> s(tone.data(), static_cast<Index>(tone.size()));
    tone_.emplace_back(s * s.adjoint());
  }
}

PreparedPlace WaveLikelihood::prepare(const WavePlace& place, const WaveVariant& variant) const {
  PreparedPlace prepared{all_rays(place, variant), {}};
  const std::vector<EdgeRay>& added = added_rays(place, variant);
  const std::size_t count = prepared.rays.size();
  const std::size_t q = basis_.size();
  const double k = model_.wave_number();
  const auto terms = model_.ray_terms({prepared.rays, offsets_, 0.0, survey_sigma_}, {});
  prepared.columns.resize(static_cast<Index>(model_.dimension()), static_cast<Index>(count));
  for (std::size_t p = 0; p < count; ++p) {
    const EdgeRay* edge = p < place.rays.size() ? nullptr : &added[p - place.rays.size()];
    const Ray& ray = prepared.rays[p];
    for (std::size_t m = 0; m < offsets_.size(); ++m) {
      const double length = edge == nullptr ? norm(ray.length * ray.at_array - offsets_[m])
                                            : ray.length + edge->longer[m];
      const Value phase = std::polar(1.0, -k * (length - terms.first_length)) *
                          (edge == nullptr ? Value(1.0) : edge->factor[m]);
      for (std::size_t i = 0; i < q; ++i) {
        prepared.columns(static_cast<Index>(m * q + i), static_cast<Index>(p)) =
            phase * terms.tone[p * q + i];
      }
    }
  }
  return prepared;
}

Eigen::MatrixXcd WaveLikelihood::density_covariance(const DensityBins& bins,
                                                    const WaveVariant& variant,
                                                    double decay) const {
  const std::size_t antennas = offsets_.size();
  const auto q = static_cast<Index>(basis_.size());
  const double keep = variant.lingers ? std::exp(-kBin / decay) : 0.0;
  std::vector<Value> now(antennas * antennas);
  const auto size = static_cast<Index>(model_.dimension());
  Eigen::MatrixXcd result = Eigen::MatrixXcd::Zero(size, size);
  for (std::size_t bin = 0; bin < kBins && !bins.covariance.empty(); ++bin) {
    for (std::size_t m = 0; m < antennas; ++m) {
      for (std::size_t n = 0; n <= m; ++n) {
        Value& at = now[m * antennas + n];
        at = keep * at + bins.covariance[(bin * antennas + m) * antennas + n];
        result.block(static_cast<Index>(m) * q, static_cast<Index>(n) * q, q, q) += at * tone_[bin];
      }
    }
  }
  return (1.0 - keep) / static_cast<double>(antennas) * result;
}

PlaceModel WaveLikelihood::model_of(const WavePlace& place,
                                    const PreparedPlace& prepared,
                                    const WaveVariant& variant,
                                    const ModelError& error) const {
  const std::vector<Ray>& rays = prepared.rays;
  ObservationModel::RayTerms terms = model_.ray_terms({rays, offsets_, 0.0, survey_sigma_}, error);
  for (std::size_t p = place.rays.size(); p < rays.size() && !variant.edge_phase; ++p) {
    terms.parts[p] = {0.0, 1.0};
  }
  PlaceMoments moments(static_cast<Index>(model_.dimension()));
  Eigen::MatrixXcd s = prepared.columns;
  const std::size_t direct = model_.obstructable(place.rays);
  for (std::size_t p = 0; p < rays.size(); ++p) {
    auto one = s.col(static_cast<Index>(p));
    moments.mean.all += terms.parts[p].known * one;
    if (p == direct && p < place.rays.size()) {
      moments.mean.direct = terms.parts[p].known * one;
    }
    one *= std::sqrt(terms.parts[p].unknown);
  }
  moments.add(s);
  const double d = diffuse_share(error, terms.first_length);
  moments.diffuse = d * (1.0 - variant.traced_share);
  if (variant.traced_share > 0.0) {
    const DensityBins& bins = place.density.at(variant.density);
    const double power = d * variant.traced_share * (variant.absolute ? bins.power : 1.0);
    moments.sigma += power * density_covariance(bins, variant, error.diffuse_decay);
  }
  return moments.factorised(
      offsets_.size(), model_.diffuse_covariance(error.diffuse_decay), error.noise);
}

}  // namespace rayloc::bench
