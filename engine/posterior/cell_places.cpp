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
          {all, about_best, near / sum, {}}};
}

std::pair<double, CellMass> summarise_box(const Lattice& lattice,
                                          std::span<const PlacesAtHeight> heights) {
  std::size_t best_height = 0;
  std::size_t best = 0;
  for (std::size_t h = 0; h < heights.size(); ++h) {
    for (std::size_t i = 0; i < heights[h].log_mass.size(); ++i) {
      if (heights[h].log_mass[i] > heights[best_height].log_mass[best]) {
        best_height = h;
        best = i;
      }
    }
  }
  const double top = heights[best_height].log_mass[best];
  const auto is_beside = [](std::size_t a, std::size_t b) { return a <= b + 1 && b <= a + 1; };
  std::vector<WeightedMoments> all;
  std::vector<WeightedMoments> near;
  double sum = 0.0;
  double near_sum = 0.0;
  const double apart = heights.size() > 1 ? std::abs(heights[1].height - heights[0].height) : 0.0;
  for (std::size_t h = 0; h < heights.size(); ++h) {
    std::vector<double> mass;
    mass.reserve(lattice.size());
    for (const double one : heights[h].log_mass) {
      mass.push_back(std::exp(one - top));
    }
    const auto add = [&](const auto& take, std::vector<WeightedMoments>& to, double& total) {
      auto [share, moments] = moments_of(lattice, mass, take);
      if (share > 0.0) {
        moments.z = heights[h].height;
        moments.zz = apart * apart / 12.0;
        to.push_back({share, moments});
        total += share;
      }
    };
    add([](std::size_t, std::size_t) { return true; }, all, sum);
    if (is_beside(h, best_height)) {
      add(
          [&](std::size_t x, std::size_t y) {
            return is_beside(x, best / lattice.count_y) && is_beside(y, best % lattice.count_y);
          },
          near,
          near_sum);
    }
  }
  for (WeightedMoments& one : all) {
    one.share /= sum;
  }
  for (WeightedMoments& one : near) {
    one.share /= near_sum;
  }
  return {top + std::log(sum), {mixture_of(all), mixture_of(near), near_sum / sum, {}}};
}

CellMoments mixture_of(std::span<const WeightedMoments> parts) {
  CellMoments m;
  for (const auto& [share, of] : parts) {
    m.x += share * of.x;
    m.y += share * of.y;
    m.z += share * of.z;
  }
  for (const auto& [share, of] : parts) {
    const Vec3d d{of.x - m.x, of.y - m.y, of.z - m.z};
    m.xx += share * (of.xx + d.x * d.x);
    m.xy += share * (of.xy + d.x * d.y);
    m.yy += share * (of.yy + d.y * d.y);
    m.xz += share * (of.xz + d.x * d.z);
    m.yz += share * (of.yz + d.y * d.z);
    m.zz += share * (of.zz + d.z * d.z);
  }
  return m;
}

}  // namespace rayloc
