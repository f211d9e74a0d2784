#include "engine/likelihood/known_rays.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

namespace rayloc {
namespace {

using Eigen::Index;

}  // namespace

KnownRays known_rays(const ObservationModel& model,
                     const ObservationModel::Place& place,
                     const ObservationModel::RayTerms& terms,
                     std::size_t most,
                     double left_out) {
  std::vector<double> power(place.rays.size());
  for (std::size_t p = 0; p < power.size(); ++p) {
    power[p] = std::norm(terms.parts[p].known * place.rays[p].amplitude);
  }
  std::vector<std::size_t> order(power.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return power[a] > power[b];
  });
  double left = std::accumulate(power.begin(), power.end(), 0.0);
  const double least = left_out * left;
  KnownRays known;
  for (std::size_t i = 0; i < order.size() && i < most && (i == 0 || left > least); ++i) {
    left -= power[order[i]];
    known.rays.push_back(order[i]);
  }
  const auto direct =
      std::find(known.rays.begin(), known.rays.end(), model.obstructable(place.rays));
  if (direct != known.rays.end()) {
    known.has_direct = true;
    std::rotate(known.rays.begin(), direct, direct + 1);
  }
  return known;
}

Eigen::VectorXcd array_of(const ObservationModel& model,
                          const ObservationModel::Place& place,
                          const ObservationModel::RayTerms& terms,
                          std::size_t p) {
  const std::size_t antennas = place.element_offset.size();
  const std::size_t q = model.dimension() / antennas;
  const Ray& ray = place.rays[p];
  Eigen::VectorXcd s(static_cast<Index>(model.dimension()));
  for (std::size_t m = 0; m < antennas; ++m) {
    const double length = norm(ray.length * ray.at_array - place.element_offset[m]);
    const std::complex<double> phase =
        std::polar(1.0, -model.wave_number() * (length - terms.first_length));
    for (std::size_t i = 0; i < q; ++i) {
      s(static_cast<Index>(m * q + i)) = phase * terms.tone[p * q + i];
    }
  }
  return s;
}

PlaceMoments unknown_moments(const ObservationModel& model,
                             const ObservationModel::Place& place,
                             const ModelError& error,
                             const ObservationModel::RayTerms& terms,
                             const KnownRays& known) {
  const auto size = static_cast<Index>(model.dimension());
  PlaceMoments moments(size);
  Eigen::MatrixXcd unknown(size, static_cast<Index>(place.rays.size()));
  for (std::size_t p = 0; p < place.rays.size(); ++p) {
    const auto& parts = terms.parts[p];
    const bool is_known = std::find(known.rays.begin(), known.rays.end(), p) != known.rays.end();
    const double share = parts.unknown + (is_known ? 0.0 : parts.known * parts.known);
    unknown.col(static_cast<Index>(p)) = std::sqrt(share) * array_of(model, place, terms, p);
  }
  moments.add(unknown);
  moments.diffuse = diffuse_share(error, terms.first_length);
  return moments;
}

}  // namespace rayloc
