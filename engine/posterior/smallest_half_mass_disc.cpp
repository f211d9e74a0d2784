#include "engine/posterior/smallest_half_mass_disc.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr double kGrowth = 1.2;  // a ratio, chosen: step from one radius to the next
// Centres are a radius divided by this apart, but at least one cell.
constexpr double kMiddles = 8.0;

// Masses of discs of cells.
class DiscMasses {
 public:
  DiscMasses(const Grid& grid, const std::vector<double>& mass)
      : grid_(grid), below_(grid.count_x * (grid.count_y + 1)) {
    for (std::size_t x = 0; x < grid.count_x; ++x) {
      double* row = below_.data() + x * (grid.count_y + 1);
      for (std::size_t y = 0; y < grid.count_y; ++y) {
        row[y + 1] = row[y] + mass[x * grid.count_y + y];
      }
    }
  }

  struct Heaviest {
    std::size_t cell = 0;  // at the centre
    double mass = -1.0;
  };
  // The heaviest disc of this radius, with centres at every `stride`th cell of a row and a column.
  Heaviest heaviest(double radius, std::size_t stride) const {
    std::vector<std::size_t> along;  // half length of a row, by its distance from the centre
    for (double across = 0.0; across <= radius; across += grid_.step_x) {
      along.push_back(
          static_cast<std::size_t>(std::sqrt(radius * radius - across * across) / grid_.step_y));
    }
    Heaviest best;
    for (std::size_t x = 0; x < grid_.count_x; x += stride) {
      for (std::size_t y = 0; y < grid_.count_y; y += stride) {
        const double mass = about(x, y, along);
        if (mass > best.mass) {
          best = {x * grid_.count_y + y, mass};
        }
      }
    }
    return best;
  }

 private:
  double about(std::size_t x, std::size_t y, const std::vector<std::size_t>& along) const {
    double sum = of_row(x, y, along[0]);
    for (std::size_t i = 1; i < along.size(); ++i) {
      sum += i <= x ? of_row(x - i, y, along[i]) : 0.0;
      sum += x + i < grid_.count_x ? of_row(x + i, y, along[i]) : 0.0;
    }
    return sum;
  }
  double of_row(std::size_t x, std::size_t y, std::size_t along) const {
    const double* row = below_.data() + x * (grid_.count_y + 1);
    return row[std::min(y + along + 1, grid_.count_y)] - row[y - std::min(y, along)];
  }

  const Grid& grid_;
  std::vector<double> below_;  // [x][y], sum over the cells of a row before y
};

}  // namespace

Disc smallest_half_mass_disc(const Grid& grid, const std::vector<double>& mass, double least) {
  RAYLOC_CHECK(mass.size() == grid.size() && least > 0.0);
  const DiscMasses discs(grid, mass);
  const double most = grid.step_x * static_cast<double>(grid.count_x) +
                      grid.step_y * static_cast<double>(grid.count_y);
  for (double radius = least;; radius *= kGrowth) {
    const auto stride = static_cast<std::size_t>(
        std::max(1.0, radius / (kMiddles * std::max(grid.step_x, grid.step_y))));
    const auto [cell, held] = discs.heaviest(radius, stride);
    if (held >= 0.5 || radius > most) {
      return {grid.centre(cell), radius};
    }
  }
}

}  // namespace rayloc
