#include "engine/track/grid_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr int kDirections = 8;  // a count, METHODS B6: 45 degrees apart
// Probability below which a cell is empty; keeps the arithmetic out of the subnormal numbers.
constexpr float kEmpty = 1e-30F;

// Moves `share` of each cell's mass over the link to the cell `stride` further, or back from it.
// The order of the cells is such that no mass moves twice.
void move(const std::vector<std::uint8_t>& links,
          std::size_t stride,
          double share,
          std::vector<float>& mass) {
  const auto part = static_cast<float>(std::abs(share));
  const std::size_t count = mass.size() - stride;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t i = share > 0.0 ? count - 1 - n : n;
    const std::size_t from = share > 0.0 ? i : i + stride;
    const std::size_t to = share > 0.0 ? i + stride : i;
    const float flow = links[i] != 0 ? part * mass[from] : 0.0F;
    mass[from] -= flow;
    mass[to] += flow;
  }
}

double sum_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

GridFilter::GridFilter(std::shared_ptr<const FreeSpace> space, MotionModel motion)
    : space_(std::move(space)), motion_(std::move(motion)) {
  RAYLOC_CHECK(!motion_.walking_speeds.empty());
  modes_.push_back({0.0, 0.0, {space_->free.begin(), space_->free.end()}});
  const auto walks = static_cast<float>(kDirections * motion_.walking_speeds.size());
  for (const double speed : motion_.walking_speeds) {
    RAYLOC_CHECK(speed > 0.0);
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      Mode mode{speed * std::cos(angle), speed * std::sin(angle), modes_.front().mass};
      for (float& value : mode.mass) {
        value /= walks;
      }
      modes_.push_back(std::move(mode));
    }
  }
  normalise();
}

void GridFilter::normalise() {
  double sum = 0.0;
  for (const Mode& mode : modes_) {
    sum += sum_of(mode.mass);
  }
  const auto scale = static_cast<float>(1.0 / sum);
  for (Mode& mode : modes_) {
    for (float& value : mode.mass) {
      value *= scale;
      value = value < kEmpty ? 0.0F : value;
    }
  }
}

// Between standing and walking, and between the directions and speeds of a walk.
void GridFilter::change_modes(double seconds) {
  const auto switched =
      static_cast<float>(-0.5 * std::expm1(-2.0 * motion_.switching_rate * seconds));
  const auto turned = static_cast<float>(-std::expm1(-seconds / motion_.direction_time));
  const auto walks = static_cast<float>(modes_.size() - 1);
  std::vector<float>& stand = modes_.front().mass;
  for (std::size_t cell = 0; cell < stand.size(); ++cell) {
    float walking = 0.0F;
    for (std::size_t k = 1; k < modes_.size(); ++k) {
      walking += modes_[k].mass[cell];
    }
    const float keep = (1.0F - switched) * (1.0F - turned);
    const float share = ((1.0F - switched) * turned * walking + switched * stand[cell]) / walks;
    for (std::size_t k = 1; k < modes_.size(); ++k) {
      modes_[k].mass[cell] = keep * modes_[k].mass[cell] + share;
    }
    stand[cell] = (1.0F - switched) * stand[cell] + switched * walking;
  }
}

void GridFilter::carry(Mode& mode, double seconds) const {
  const RoomGrid& grid = space_->grid;
  const double cells_x = mode.velocity_x * seconds / grid.step_x;
  const double cells_y = mode.velocity_y * seconds / grid.step_y;
  const double steps = std::max(1.0, std::ceil(std::max(std::abs(cells_x), std::abs(cells_y))));
  for (auto left = static_cast<std::size_t>(steps); left > 0; --left) {
    move(space_->link_x, grid.count_y, cells_x / steps, mode.mass);
    move(space_->link_y, 1, cells_y / steps, mode.mass);
  }
}

void GridFilter::predict(Duration elapsed) {
  RAYLOC_CHECK(elapsed >= Duration::zero());
  // A walk that turns on its way: modes change in between.
  const double seconds = to_seconds(elapsed);
  const double parts = std::max(1.0, std::ceil(4.0 * seconds / motion_.direction_time));
  for (auto left = static_cast<std::size_t>(parts); left > 0; --left) {
    change_modes(seconds / parts);
    for (std::size_t k = 1; k < modes_.size(); ++k) {
      carry(modes_[k], seconds / parts);
    }
  }
}

void GridFilter::weigh_change(double change) {
  const auto stand = static_cast<float>(std::pow(motion_.change_odds, -change));
  const auto walk = static_cast<float>(std::pow(motion_.change_odds, change - 1.0));
  for (Mode& mode : modes_) {
    const float weight = &mode == &modes_.front() ? stand : walk;
    for (float& value : mode.mass) {
      value *= weight;
    }
  }
  normalise();
}

void GridFilter::update(std::span<const double> log_likelihood, double exponent, double elsewhere) {
  RAYLOC_CHECK(log_likelihood.size() == space_->grid.size() && exponent >= 0.0);
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  std::vector<double> likelihood(log_likelihood.size());
  double sum = 0.0;
  double cells = 0.0;
  for (std::size_t i = 0; i < likelihood.size(); ++i) {
    if (space_->free[i] != 0) {
      likelihood[i] = std::exp(exponent * (log_likelihood[i] - top));
      sum += likelihood[i];
      cells += 1.0;
    }
  }
  const double outlier = std::clamp(elsewhere, motion_.outlier, 1.0);
  // Over the mean of the free cells, so that numbers stay near 1.
  const double scale = sum > 0.0 ? (1.0 - outlier) * cells / sum : 0.0;
  for (std::size_t i = 0; i < likelihood.size(); ++i) {
    const auto value = static_cast<float>(scale * likelihood[i] + outlier);
    for (Mode& mode : modes_) {
      mode.mass[i] *= value;
    }
  }
  normalise();
}

std::vector<double> GridFilter::mass() const {
  std::vector<double> mass(space_->grid.size());
  for (const Mode& mode : modes_) {
    for (std::size_t cell = 0; cell < mass.size(); ++cell) {
      mass[cell] += static_cast<double>(mode.mass[cell]);
    }
  }
  const double sum = std::accumulate(mass.begin(), mass.end(), 0.0);
  for (double& value : mass) {
    value /= sum;
  }
  return mass;
}

double GridFilter::standing() const { return sum_of(modes_.front().mass); }

}  // namespace rayloc
