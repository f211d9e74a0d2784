#include "engine/posterior/cell_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/likelihood/nearby_likelihood.h"

namespace rayloc {

namespace {

// Of the places from which `take` is true; their mass.
template <typename Take>
std::pair<double, CellMoments> moments_of(const Lattice& lattice,
                                          const std::vector<double>& mass,
                                          const Take& take) {
  double sum = 0.0;
  CellMoments m;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const std::size_t x = i / lattice.count_y;
    const std::size_t y = i % lattice.count_y;
    if (!take(x, y)) {
      continue;
    }
    const Vec3d p = lattice.offset(x, y);
    sum += mass[i];
    m.x += mass[i] * p.x;
    m.y += mass[i] * p.y;
    m.xx += mass[i] * p.x * p.x;
    m.xy += mass[i] * p.x * p.y;
    m.yy += mass[i] * p.y * p.y;
  }
  m.x /= sum;
  m.y /= sum;
  m.xx = m.xx / sum - m.x * m.x + lattice.step_x * lattice.step_x / 12.0;
  m.xy = m.xy / sum - m.x * m.y;
  m.yy = m.yy / sum - m.y * m.y + lattice.step_y * lattice.step_y / 12.0;
  return {sum, m};
}

}  // namespace

Lattice places_of_cell(const RoomGrid& grid, double wavelength) {
  const double most = NearbyLikelihood::kPlaceDistance * wavelength;
  Lattice result;
  result.count_x = static_cast<std::size_t>(std::ceil(grid.step_x / most));
  result.count_y = static_cast<std::size_t>(std::ceil(grid.step_y / most));
  result.step_x = grid.step_x / static_cast<double>(result.count_x);
  result.step_y = grid.step_y / static_cast<double>(result.count_y);
  return result;
}

std::pair<double, CellMass> summarise_places(const Lattice& lattice,
                                             std::span<const double> log_likelihood,
                                             double likelihood_exponent) {
  const auto best = static_cast<std::size_t>(
      std::max_element(log_likelihood.begin(), log_likelihood.end()) - log_likelihood.begin());
  const double top = log_likelihood[best];
  std::vector<double> mass;
  mass.reserve(log_likelihood.size());
  for (const double one : log_likelihood) {
    mass.push_back(std::exp(likelihood_exponent * (one - top)));
  }
  const auto is_beside = [](std::size_t a, std::size_t b) { return a <= b + 1 && b <= a + 1; };
  const auto [sum, all] = moments_of(lattice, mass, [](std::size_t, std::size_t) { return true; });
  const auto [near, about_best] = moments_of(lattice, mass, [&](std::size_t x, std::size_t y) {
    return is_beside(x, best / lattice.count_y) && is_beside(y, best % lattice.count_y);
  });
  return {top + std::log(sum / static_cast<double>(log_likelihood.size())) / likelihood_exponent,
          {all, about_best, near / sum}};
}

}  // namespace rayloc
