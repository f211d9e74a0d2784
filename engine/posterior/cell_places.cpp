#include "engine/posterior/cell_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/likelihood/nearby_likelihood.h"

namespace rayloc {

namespace {

// Mass and moments of the places for which `take` is true.
template <typename Masses, typename Take>
std::pair<double, CellMoments> moments_of(const Lattice& lattice,
                                          const Masses& mass,
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
    const auto here = static_cast<double>(mass[i]);
    sum += here;
    m.x += here * p.x;
    m.y += here * p.y;
    m.xx += here * p.x * p.x;
    m.xy += here * p.x * p.y;
    m.yy += here * p.y * p.y;
  }
  m.x /= sum;
  m.y /= sum;
  m.xx = m.xx / sum - m.x * m.x + lattice.step_x * lattice.step_x / 12.0;
  m.xy = m.xy / sum - m.x * m.y;
  m.yy = m.yy / sum - m.y * m.y + lattice.step_y * lattice.step_y / 12.0;
  return {sum, m};
}

}  // namespace

Lattice places_of_cell(const Grid& grid, double wavelength) {
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
  double top = heights.front().log_mass.front();
  for (const PlacesAtHeight& one : heights) {
    top = std::max(top, *std::max_element(one.log_mass.begin(), one.log_mass.end()));
  }
  std::vector<double> at;
  std::vector<float> mass;
  mass.reserve(heights.size() * lattice.size());
  for (const PlacesAtHeight& one : heights) {
    at.push_back(one.height);
    for (const double log_mass : one.log_mass) {
      mass.push_back(static_cast<float>(std::exp(log_mass - top)));
    }
  }
  const auto [sum, where] = summarise_masses(lattice, at, mass);
  return {top + std::log(sum), where};
}

std::pair<double, CellMass> summarise_masses(const Lattice& lattice,
                                             std::span<const double> heights,
                                             std::span<const float> mass) {
  const auto peak =
      static_cast<std::size_t>(std::max_element(mass.begin(), mass.end()) - mass.begin());
  const std::size_t best_height = peak / lattice.size();
  const std::size_t best = peak % lattice.size();
  const auto is_beside = [](std::size_t a, std::size_t b) { return a <= b + 1 && b <= a + 1; };
  std::vector<WeightedMoments> all;
  std::vector<WeightedMoments> near;
  double sum = 0.0;
  double near_sum = 0.0;
  const double apart = heights.size() > 1 ? std::abs(heights[1] - heights[0]) : 0.0;
  for (std::size_t h = 0; h < heights.size(); ++h) {
    const auto of_height = mass.subspan(h * lattice.size(), lattice.size());
    const auto add = [&](const auto& take, std::vector<WeightedMoments>& to, double& total) {
      auto [share, moments] = moments_of(lattice, of_height, take);
      if (share > 0.0) {
        moments.z = heights[h];
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
  return {sum, {mixture_of(all), mixture_of(near), near_sum / sum, {}}};
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

CellMoments rest_of(const CellMass& cell) {
  const CellMoments& all = cell.all;
  const CellMoments& best = cell.best;
  const double share = cell.best_share;
  const double rest = 1.0 - share;
  if (!(rest > 0.0)) {
    return all;
  }
  CellMoments m;
  m.x = (all.x - share * best.x) / rest;
  m.y = (all.y - share * best.y) / rest;
  m.z = (all.z - share * best.z) / rest;
  const auto second =
      [&](double of_all, double of_best, double a, double b, double r, double mean) {
        return (of_all + a * r - share * (of_best + b * mean)) / rest;
      };
  m.xx = second(all.xx, best.xx, all.x, best.x, all.x, best.x) - m.x * m.x;
  m.xy = second(all.xy, best.xy, all.x, best.x, all.y, best.y) - m.x * m.y;
  m.yy = second(all.yy, best.yy, all.y, best.y, all.y, best.y) - m.y * m.y;
  m.xz = second(all.xz, best.xz, all.x, best.x, all.z, best.z) - m.x * m.z;
  m.yz = second(all.yz, best.yz, all.y, best.y, all.z, best.z) - m.y * m.z;
  m.zz = second(all.zz, best.zz, all.z, best.z, all.z, best.z) - m.z * m.z;
  return m;
}

}  // namespace rayloc
