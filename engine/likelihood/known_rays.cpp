#include "engine/likelihood/known_rays.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include <Eigen/Core>

namespace rayloc {
namespace {

using Eigen::Index;

}  // namespace

std::vector<std::size_t> strongest(std::span<const double> power,
                                   std::size_t most,
                                   double left_out) {
  std::vector<std::size_t> order(power.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return power[a] > power[b];
  });
  double left = std::accumulate(power.begin(), power.end(), 0.0);
  const double least = left_out * left;
  std::size_t kept = 0;
  while (kept < order.size() && kept < most && (kept == 0 || left > least)) {
    left -= power[order[kept++]];
  }
  order.resize(kept);
  return order;
}

KnownRays known_rays(const ObservationModel& model,
                     const ObservationModel::Place& place,
                     const ObservationModel::RayTerms& terms,
                     std::size_t most,
                     double left_out) {
  std::vector<double> power(place.rays.size());
  for (std::size_t p = 0; p < power.size(); ++p) {
    power[p] = std::norm(terms.parts[p].known * place.rays[p].amplitude);
  }
  KnownRays known;
  known.rays = strongest(power, most, left_out);
  const auto direct =
      std::find(known.rays.begin(), known.rays.end(), model.obstructable(place.rays));
  if (direct != known.rays.end()) {
    known.has_direct = true;
    std::rotate(known.rays.begin(), direct, direct + 1);
  }
  return known;
}

std::vector<double> unknown_shares(const ObservationModel::RayTerms& terms,
                                   const KnownRays& known) {
  std::vector<bool> is_known(terms.parts.size());
  for (const std::size_t p : known.rays) {
    is_known[p] = true;
  }
  std::vector<double> shares;
  shares.reserve(terms.parts.size());
  for (std::size_t p = 0; p < terms.parts.size(); ++p) {
    const auto& parts = terms.parts[p];
    shares.push_back(parts.unknown + (is_known[p] ? 0.0 : parts.known * parts.known));
  }
  return shares;
}

PlaceMoments unknown_moments(const ObservationModel& model,
                             const ObservationModel::Place& place,
                             const ModelError& error,
                             const ObservationModel::RayTerms& terms,
                             const KnownRays& known) {
  const auto size = static_cast<Index>(model.dimension());
  PlaceMoments moments(size);
  Eigen::MatrixXcd unknown(size, static_cast<Index>(place.rays.size()));
  const std::vector<double> shares = unknown_shares(terms, known);
  for (std::size_t p = 0; p < place.rays.size(); ++p) {
    auto s = unknown.col(static_cast<Index>(p));
    model.put_array(place, terms, p, {s.data(), model.dimension()});
    s *= std::sqrt(shares[p]);
  }
  moments.add(unknown);
  moments.diffuse = diffuse_share(error, terms.first_length);
  return moments;
}

}  // namespace rayloc
