#include "engine/track/cloud_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/grid/cell_mass.h"
#include "engine/grid/cell_window.h"
#include "engine/localize/search_area.h"
#include "engine/track/filter_summary.h"

namespace rayloc {
namespace {

constexpr double kOutOfSide = 2.5e-5;     // a probability, chosen: left out at each of four sides
constexpr double kVelocityRadius = 0.15;  // [m], that of a position in posterior/posterior
constexpr double kLargerCells = 1.05;     // a ratio, chosen
constexpr std::size_t kMaxCells = kSummaryWindow + kSummaryWindow / 10;  // of a narrow part

// First and count of the rows that hold all but the mass of two sides, and one more on each side.
std::array<std::size_t, 2> kept_rows(const std::vector<double>& mass, double all) {
  auto [begin, end] = kept_range(mass, kOutOfSide * all);
  begin -= std::min<std::size_t>(begin, 1);
  end = std::min(end + 1, mass.size());
  return {begin, end - begin};
}

// Cells of about `step` over the same part of the room.
Grid with_cells(const Grid& part, double step) {
  const Vec3d low{part.first.x - 0.5 * part.step_x, part.first.y - 0.5 * part.step_y, 0.0};
  const Vec3d widths{part.step_x * static_cast<double>(part.count_x),
                     part.step_y * static_cast<double>(part.count_y),
                     0.0};
  Grid other(low, low + widths, part.first.z, step);
  other.height_sigma = part.height_sigma;
  other.layers = part.layers;
  return other;
}

std::size_t occupied_cells(const PlaceCloud& cloud,
                           std::span<const float> weights,
                           const Grid& part) {
  std::vector<char> is_occupied(part.size() + 1);  // the last one: outside
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (weights[i] > 0.0F) {
      is_occupied[cell_of(cloud, i, part)] = 1;
    }
  }
  return static_cast<std::size_t>(std::count(is_occupied.begin(), is_occupied.end() - 1, 1));
}

// Sums of the places of a cell, relative to its centre.
struct CellSums {
  double mass = 0.0;
  Vec3d first;
  CellMoments second;  // only its products

  void add(double weight, const Vec3d& d) {
    mass += weight;
    first = first + weight * d;
    second.xx += weight * d.x * d.x;
    second.xy += weight * d.x * d.y;
    second.yy += weight * d.y * d.y;
    second.xz += weight * d.x * d.z;
    second.yz += weight * d.y * d.z;
    second.zz += weight * d.z * d.z;
  }
  CellMoments moments() const {
    const Vec3d m = (1.0 / mass) * first;
    return {m.x,
            m.y,
            std::max(0.0, second.xx / mass - m.x * m.x),
            second.xy / mass - m.x * m.y,
            std::max(0.0, second.yy / mass - m.y * m.y),
            m.z,
            second.xz / mass - m.x * m.z,
            second.yz / mass - m.y * m.z,
            std::max(0.0, second.zz / mass - m.z * m.z)};
  }
};

std::vector<CellSums> sums_of(const PlaceCloud& cloud,
                              std::span<const float> weights,
                              const Grid& part) {
  std::vector<CellSums> sums(part.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (weights[i] <= 0.0F) {
      continue;
    }
    const std::size_t cell = cell_of(cloud, i, part);
    if (cell < part.size()) {
      const Vec3d position{static_cast<double>(cloud.x()[i]),
                           static_cast<double>(cloud.y()[i]),
                           static_cast<double>(cloud.z()[i])};
      sums[cell].add(static_cast<double>(weights[i]), position - part.centre(cell));
    }
  }
  return sums;
}

// Sets the weights of places outside the area to 0; returns their sum.
double take_places_outside(const PlaceCloud& cloud,
                           const Grid& grid,
                           std::span<const char> inside,
                           std::vector<float>& weights) {
  double outside = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t cell = cell_of(cloud, i, grid);
    const bool is_inside = cell < grid.size() && (inside.empty() || inside[cell] != 0);
    if (!is_inside) {
      outside += static_cast<double>(weights[i]);
      weights[i] = 0.0F;
    }
  }
  return std::min(outside, 1.0);
}

}  // namespace

Grid summary_grid(const PlaceCloud& cloud, std::span<const float> weights, const Grid& grid) {
  std::vector<double> by_x(grid.count_x);
  std::vector<double> by_y(grid.count_y);
  double all = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t cell = cell_of(cloud, i, grid);
    if (cell < grid.size()) {
      const auto weight = static_cast<double>(weights[i]);
      by_x[cell / grid.count_y] += weight;
      by_y[cell % grid.count_y] += weight;
      all += weight;
    }
  }
  RAYLOC_CHECK(all > 0.0);
  const auto x = kept_rows(by_x, all);
  const auto y = kept_rows(by_y, all);
  const Grid part = CellWindow{x[0], y[0], x[1], y[1]}.grid_of(grid);
  Grid cells = part;
  double step = std::sqrt(part.step_x * part.step_y);
  if (part.size() > kSummaryWindow) {
    step *= std::sqrt(static_cast<double>(part.size()) / static_cast<double>(kSummaryWindow));
    cells = with_cells(part, step);
  }
  for (std::size_t occupied = occupied_cells(cloud, weights, cells);
       cells.size() > kMaxCells || occupied > kSummaryCells;
       occupied = occupied_cells(cloud, weights, cells)) {
    const double times = static_cast<double>(occupied) / static_cast<double>(kSummaryCells);
    step *= std::max(kLargerCells, std::sqrt(times));
    cells = with_cells(part, step);
  }
  return cells;
}

double summarise_cloud(const PlaceCloud& cloud,
                       const Grid& grid,
                       std::span<const char> inside,
                       PosteriorOptions options,
                       LocationEstimate& location) {
  RAYLOC_CHECK(inside.empty() || inside.size() == grid.size());
  std::vector<float> weights = cloud.weights();
  const auto is_weighed = [](float one) { return one > 0.0F; };
  if (std::none_of(weights.begin(), weights.end(), is_weighed)) {
    location.reason = "no place of the cloud is possible";
    return 1.0;
  }
  const double outside = take_places_outside(cloud, grid, inside, weights);
  if (std::none_of(weights.begin(), weights.end(), is_weighed)) {
    location.reason = SearchArea::kBeside;
    return 1.0;
  }
  const Grid part = summary_grid(cloud, weights, grid);
  const std::vector<CellSums> sums = sums_of(cloud, weights, part);
  std::vector<double> mass(part.size());
  RefinedCells within;
  for (std::size_t cell = 0; cell < sums.size(); ++cell) {
    mass[cell] = sums[cell].mass;
    if (mass[cell] > 0.0) {
      const CellMoments moments = sums[cell].moments();
      within.emplace_back(cell, CellMass{moments, moments, 1.0, {}});
    }
  }
  options.likelihood_exponent = 1.0;
  options.outlier = 1.0 - (1.0 - outside) * (1.0 - options.outlier);
  options.cells_of_room =
      static_cast<double>(grid.size()) * grid.step_x * grid.step_y / (part.step_x * part.step_y);
  summarise_posterior(part, log_masses(std::move(mass)), options, location, within);
  return outside;
}

Vec3d velocity_of(const PlaceCloud& cloud, const Vec3d& position) {
  const std::vector<float> weights = cloud.weights();
  Vec3d near;
  Vec3d all;
  double near_mass = 0.0;
  double mass = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto weight = static_cast<double>(weights[i]);
    const Vec3d velocity{static_cast<double>(cloud.u()[i]), static_cast<double>(cloud.v()[i]), 0.0};
    mass += weight;
    all = all + weight * velocity;
    const double x = static_cast<double>(cloud.x()[i]) - position.x;
    const double y = static_cast<double>(cloud.y()[i]) - position.y;
    if (x * x + y * y <= kVelocityRadius * kVelocityRadius) {
      near_mass += weight;
      near = near + weight * velocity;
    }
  }
  if (near_mass > 0.0) {
    return (1.0 / near_mass) * near;
  }
  return mass > 0.0 ? (1.0 / mass) * all : Vec3d{};
}

}  // namespace rayloc
