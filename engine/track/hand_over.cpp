#include "engine/track/hand_over.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/posterior/cell_places.h"

namespace rayloc {
namespace {

// [m^2/s^2], chosen: variance of the velocity of a mode: it covers the speeds between modes.
constexpr float kModeVariance = 0.09F;
constexpr double kSameDistance = 0.1;   // [m/s], chosen: modes that are about as near
constexpr int kTries = 8;               // a count, chosen: to draw a place that no wall hides
constexpr double kMinDeviation = 1e-6;  // [m], of a height
constexpr double kInLayers = 1e-4;      // [m], distance of a height from the limits of the layers

// Index of the entry at `share` of the sum of the values.
std::size_t entry_at(std::span<const double> values, double share) {
  const double goal = share * std::accumulate(values.begin(), values.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    sum += values[i];
    if (sum > goal) {
      return i;
    }
  }
  return values.size() - 1;
}

// An offset from the centre of a cell: horizontally normal given the height.
Vec3d draw_given_height(const CellMoments& m, double z, NormalDraws& draws) {
  const double variance = std::max(m.zz, kMinDeviation * kMinDeviation);
  const double along_x = m.xz / variance;
  const double along_y = m.yz / variance;
  const double a = std::sqrt(std::max(0.0, m.xx - along_x * m.xz));
  const double b = a > 0.0 ? (m.xy - along_x * m.yz) / a : 0.0;
  const double c = std::sqrt(std::max(0.0, m.yy - along_y * m.yz - b * b));
  const auto first = static_cast<double>(draws.normal());
  const auto second = static_cast<double>(draws.normal());
  return {
      m.x + along_x * (z - m.z) + a * first, m.y + along_y * (z - m.z) + b * first + c * second, z};
}

// Draws places in one cell after another.
class CellDraws {
 public:
  CellDraws(const FreeSpace& space, std::span<const double> layers, NormalDraws& draws)
      : space_(space), draws_(draws) {
    const HeightLayers& heights = space.grid.layers;
    RAYLOC_CHECK(heights.is_known() || layers.empty() || layers.size() == heights.size());
    const std::span<const double> of_room =
        heights.is_known() || layers.empty() ? std::span<const double>(heights.weight) : layers;
    of_room_.assign(of_room.begin(), of_room.end());
  }

  // mass: distribution in the cell; nullptr: uniform.
  void enter(std::size_t cell, const CellMass* mass) {
    cell_ = cell;
    mass_ = mass;
    layers_ = of_room_;
    if (mass == nullptr) {
      return;
    }
    rest_ = rest_of(*mass);
    const HeightLayers& heights = space_.grid.layers;
    if (heights.is_known() || mass->layers.size() != heights.size()) {
      return;
    }
    const double sigma = std::max(std::sqrt(std::max(mass->best.zz, 0.0)), kMinDeviation);
    const std::vector<double> best = layer_probabilities(heights, mass->best.z, sigma);
    layers_.assign(mass->layers.begin(), mass->layers.end());
    double sum = 0.0;
    for (const double one : layers_) {
      sum += one;
    }
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      layers_[i] = std::max(0.0, layers_[i] - mass->best_share * sum * best[i]);
    }
    if (std::none_of(layers_.begin(), layers_.end(), [](double one) { return one > 0.0; })) {
      layers_ = of_room_;
    }
  }

  CloudPlace draw() {
    CloudPlace place;
    for (int i = 0; i < kTries; ++i) {
      place = rounded(position());
      const std::size_t at =
          space_.grid.cell_at(static_cast<double>(place.x), static_cast<double>(place.y));
      if (at == cell_ || (at < space_.grid.size() && is_open(space_, cell_, at))) {
        return place;
      }
    }
    const Vec3d centre = space_.grid.centre(cell_);
    place.x = static_cast<float>(centre.x);
    place.y = static_cast<float>(centre.y);
    return place;
  }

 private:
  static CloudPlace rounded(const Vec3d& position) {
    CloudPlace place;
    place.x = static_cast<float>(position.x);
    place.y = static_cast<float>(position.y);
    place.z = static_cast<float>(position.z);
    return place;
  }

  // [m], above the grid's height.
  double height() {
    const HeightLayers& heights = space_.grid.layers;
    if (heights.is_known()) {
      return 0.0;
    }
    const std::size_t layer = entry_at(layers_, draws_.uniform());
    return heights.offset[layer] + heights.thickness * (draws_.uniform() - 0.5);
  }

  Vec3d position() {
    const Grid& grid = space_.grid;
    const Vec3d centre = grid.centre(cell_);
    if (mass_ == nullptr) {
      const double x = grid.step_x * (draws_.uniform() - 0.5);
      const double y = grid.step_y * (draws_.uniform() - 0.5);
      return centre + Vec3d{x, y, height()};
    }
    if (draws_.uniform() >= mass_->best_share) {
      return centre + draw_given_height(rest_, grid.layers.is_known() ? rest_.z : height(), draws_);
    }
    const CellMoments& best = mass_->best;
    if (grid.layers.is_known()) {
      return centre + draw_given_height(best, best.z, draws_);
    }
    const double half = 0.5 * grid.layers.thickness - kInLayers;
    const double z = std::clamp(
        best.z + std::sqrt(std::max(0.0, best.zz)) * static_cast<double>(draws_.normal()),
        grid.layers.offset.front() - half,
        grid.layers.offset.back() + half);
    return centre + draw_given_height(best, z, draws_);
  }

  const FreeSpace& space_;
  NormalDraws& draws_;
  std::vector<double> of_room_;  // probabilities of the layers where a cell has none
  std::size_t cell_ = 0;
  const CellMass* mass_ = nullptr;
  CellMoments rest_;
  std::vector<double> layers_;  // of the places that are not around the best one
};

// The modes of walking that share the mass of a place.
std::vector<std::size_t> modes_near(const std::vector<GridFilter::ModeView>& modes,
                                    const CloudPlace& place) {
  std::vector<double> distance(modes.size());
  double least = 0.0;
  for (std::size_t k = 1; k < modes.size(); ++k) {
    distance[k] = std::hypot(modes[k].velocity_x - static_cast<double>(place.u),
                             modes[k].velocity_y - static_cast<double>(place.v));
    least = k == 1 ? distance[k] : std::min(least, distance[k]);
  }
  std::vector<std::size_t> near;
  for (std::size_t k = 1; k < modes.size(); ++k) {
    if (distance[k] <= least + kSameDistance) {
      near.push_back(k);
    }
  }
  return near;
}

}  // namespace

PlaceCloud cloud_of(const GridFilter& filter,
                    const FreeSpace& space,
                    const RefinedCells& within,
                    std::span<const double> layers,
                    std::size_t count,
                    NormalDraws& draws) {
  const std::vector<GridFilter::ModeView> modes = filter.modes();
  const CellWindow& window = filter.window();
  std::vector<const CellMass*> refined(window.size(), nullptr);
  for (const auto& [cell, mass] : within) {
    if (const auto number = window.number(cell, space.grid)) {
      refined[*number] = &mass;
    }
  }
  double all = 0.0;
  for (std::size_t n = 0; n < window.size(); ++n) {
    for (const GridFilter::ModeView& mode : modes) {
      all += static_cast<double>(mode.mass[n]);
    }
  }
  RAYLOC_CHECK(count > 0 && all > 0.0);
  const double step = all / static_cast<double>(count);
  const auto log_weight = static_cast<float>(-std::log(static_cast<double>(count)));
  CellDraws cells(space, layers, draws);
  PlaceCloud cloud;
  cloud.reserve(count);
  double goal = draws.uniform() * step;
  double sum = 0.0;
  for (std::size_t n = 0; n < window.size(); ++n) {
    bool is_entered = false;
    for (std::size_t k = 0; k < modes.size(); ++k) {
      sum += static_cast<double>(modes[k].mass[n]);
      for (; goal < sum && cloud.size() < count; goal += step) {
        if (!is_entered) {
          cells.enter(window.cell(n, space.grid), refined[n]);
          is_entered = true;
        }
        CloudPlace place = cells.draw();
        place.is_resting = k == 0;
        place.u = static_cast<float>(modes[k].velocity_x);
        place.v = static_cast<float>(modes[k].velocity_y);
        place.variance = place.is_resting ? 0.0F : kModeVariance;
        cloud.add(place, log_weight);
      }
    }
  }
  return cloud;
}

GridFilter grid_of(const PlaceCloud& cloud,
                   std::shared_ptr<const FreeSpace> space,
                   const MotionModel& motion,
                   double elsewhere) {
  RAYLOC_CHECK(elsewhere >= 0.0 && elsewhere <= 1.0);
  GridFilter filter(space, motion);  // uniform
  const std::vector<GridFilter::ModeView> modes = filter.modes();
  const Grid& grid = space->grid;
  std::vector<std::vector<float>> mass(modes.size(), std::vector<float>(grid.size(), 0.0F));
  const std::vector<float> weights = cloud.weights();
  double all = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const CloudPlace place = cloud.place(i);
    const std::size_t cell = cell_of(cloud, i, grid);
    if (cell == grid.size() || space->free[cell] == 0 || weights[i] <= 0.0F) {
      continue;
    }
    all += static_cast<double>(weights[i]);
    if (place.is_resting) {
      mass.front()[cell] += weights[i];
      continue;
    }
    const std::vector<std::size_t> near = modes_near(modes, place);
    for (const std::size_t k : near) {
      mass[k][cell] += weights[i] / static_cast<float>(near.size());
    }
  }
  if (!(all > 0.0)) {
    return filter;
  }
  const auto share = static_cast<float>((1.0 - elsewhere) / all);
  const auto uniform = static_cast<float>(elsewhere);
  for (std::size_t k = 0; k < modes.size(); ++k) {
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
      mass[k][cell] = share * mass[k][cell] + uniform * modes[k].mass[cell];
    }
  }
  filter.set(mass);
  return filter;
}

std::vector<double> layers_of(const PlaceCloud& cloud, const Grid& grid) {
  const HeightLayers& heights = grid.layers;
  if (heights.is_known()) {
    return {};
  }
  std::vector<double> share(heights.size());
  const std::vector<float> weights = cloud.weights();
  const double low = grid.first.z + heights.offset.front() - 0.5 * heights.thickness;
  const auto last = static_cast<double>(heights.size() - 1);
  double all = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double layer = (static_cast<double>(cloud.z()[i]) - low) / heights.thickness;
    share[static_cast<std::size_t>(std::clamp(std::floor(layer), 0.0, last))] +=
        static_cast<double>(weights[i]);
    all += static_cast<double>(weights[i]);
  }
  if (!(all > 0.0)) {
    return {};
  }
  for (double& one : share) {
    one /= all;
  }
  return share;
}

}  // namespace rayloc
