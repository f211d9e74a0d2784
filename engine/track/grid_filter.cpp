#include "engine/track/grid_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/highest.h"
#include "engine/base/work_done.h"
#include "engine/grid/grid.h"

namespace rayloc {
namespace {

constexpr int kDirections = 8;  // a count, METHODS B6: 45 degrees apart
// Probability below which a cell is empty; keeps the arithmetic out of the subnormal numbers.
constexpr float kEmpty = 1e-30F;
// Lower limit of the probability of being outside the window, chosen: the window may be wrong, and
// bursts are compared with only a sample of the rest of the room.
constexpr double kMinAway = 1e-4;

double sum_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

GridFilter::GridFilter(std::shared_ptr<const FreeSpace> space, MotionModel motion)
    : space_(std::move(space)),
      motion_(std::move(motion)),
      window_(CellWindow::all_of(space_->grid)) {
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
  if (!window_.is_all_of(space_->grid)) {
    away_ = std::max(away_, kMinAway * (sum + away_));
    sum += away_;
    away_ /= sum;
  }
  const auto scale = static_cast<float>(1.0 / sum);
  for (Mode& mode : modes_) {
    for (float& value : mode.mass) {
      value *= scale;
      value = value < kEmpty ? 0.0F : value;
    }
  }
}

// Transitions between standing and walking, and between directions and speeds of a walk.
void GridFilter::change_modes(double seconds) {
  const auto switched =
      static_cast<float>(-0.5 * std::expm1(-2.0 * motion_.switching_rate * seconds));
  const auto rotated = static_cast<float>(-std::expm1(-seconds / motion_.direction_time));
  const auto walks = static_cast<float>(modes_.size() - 1);
  std::vector<float>& still = modes_.front().mass;
  for (std::size_t cell = 0; cell < still.size(); ++cell) {
    float walking = 0.0F;
    for (std::size_t k = 1; k < modes_.size(); ++k) {
      walking += modes_[k].mass[cell];
    }
    const float keep = (1.0F - switched) * (1.0F - rotated);
    const float share = ((1.0F - switched) * rotated * walking + switched * still[cell]) / walks;
    for (std::size_t k = 1; k < modes_.size(); ++k) {
      modes_[k].mass[cell] = keep * modes_[k].mass[cell] + share;
    }
    still[cell] = (1.0F - switched) * still[cell] + switched * walking;
  }
}

// Moves `share` of each cell's mass over the link to the next cell in x, or to the previous one.
// The order of the cells ensures that no mass moves twice.
void GridFilter::move_x(double share, std::vector<float>& mass) const {
  const auto part = static_cast<float>(std::abs(share));
  const std::size_t columns = window_.count_y;
  for (std::size_t n = 0; n + 1 < window_.count_x; ++n) {
    const std::size_t x = share > 0.0 ? window_.count_x - 2 - n : n;
    const std::uint8_t* links = space_->link_x.data() + window_.cell(x * columns, space_->grid);
    float* from = mass.data() + (share > 0.0 ? x : x + 1) * columns;
    float* to = mass.data() + (share > 0.0 ? x + 1 : x) * columns;
    for (std::size_t y = 0; y < columns; ++y) {
      const float flow = links[y] != 0 ? part * from[y] : 0.0F;
      from[y] -= flow;
      to[y] += flow;
    }
  }
}

// As move_x(), in y.
void GridFilter::move_y(double share, std::vector<float>& mass) const {
  const auto part = static_cast<float>(std::abs(share));
  const std::size_t columns = window_.count_y;
  for (std::size_t x = 0; x < window_.count_x; ++x) {
    const std::uint8_t* links = space_->link_y.data() + window_.cell(x * columns, space_->grid);
    float* row = mass.data() + x * columns;
    for (std::size_t n = 0; n + 1 < columns; ++n) {
      const std::size_t y = share > 0.0 ? columns - 2 - n : n;
      const std::size_t from = share > 0.0 ? y : y + 1;
      const std::size_t to = share > 0.0 ? y + 1 : y;
      const float flow = links[y] != 0 ? part * row[from] : 0.0F;
      row[from] -= flow;
      row[to] += flow;
    }
  }
}

void GridFilter::carry(Mode& mode, double seconds) const {
  const Grid& grid = space_->grid;
  const double cells_x = mode.velocity_x * seconds / grid.step_x;
  const double cells_y = mode.velocity_y * seconds / grid.step_y;
  const double steps = std::max(1.0, std::ceil(std::max(std::abs(cells_x), std::abs(cells_y))));
  for (auto left = static_cast<std::size_t>(steps); left > 0; --left) {
    WorkDone::add(6 * window_.size(), 26 * window_.size());
    move_x(cells_x / steps, mode.mass);
    move_y(cells_y / steps, mode.mass);
  }
}

void GridFilter::predict(Duration elapsed) {
  RAYLOC_CHECK(elapsed >= Duration::zero());
  // A walk may turn within the interval, so modes change between the partial steps.
  const double seconds = to_seconds(elapsed);
  const double parts = std::max(1.0, std::ceil(4.0 * seconds / motion_.direction_time));
  for (auto left = static_cast<std::size_t>(parts); left > 0; --left) {
    // Masses are read and written once for the mode change and once for each step of each walk.
    WorkDone::add(modes_.size() * window_.size() * 4, modes_.size() * window_.size() * 12);
    change_modes(seconds / parts);
    for (std::size_t k = 1; k < modes_.size(); ++k) {
      carry(modes_[k], seconds / parts);
    }
  }
}

void GridFilter::weigh_change(double change) {
  const auto still = static_cast<float>(std::pow(motion_.change_odds, -change));
  const auto walk = static_cast<float>(std::pow(motion_.change_odds, change - 1.0));
  if (away_ > 0.0) {  // being outside carries no information on motion
    const double stationary = this->stationary();
    away_ *=
        stationary * static_cast<double>(still) + (1.0 - stationary) * static_cast<double>(walk);
  }
  for (Mode& mode : modes_) {
    const float weight = &mode == &modes_.front() ? still : walk;
    for (float& value : mode.mass) {
      value *= weight;
    }
  }
  normalise();
}

GridFilter::Relative GridFilter::relative(std::span<const double> log_likelihood,
                                          const CellSet& cells,
                                          double exponent,
                                          double outlier) const {
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  Relative result;
  result.of.resize(log_likelihood.size());
  double sum = 0.0;
  double represented = 0.0;
  for (std::size_t n = 0; n < result.of.size(); ++n) {
    if (space_->free[cells.cell(n)] != 0) {
      const double weight = cells.weights.of(n);
      result.of[n] = std::exp(exponent * (log_likelihood[n] - top));
      sum += weight * result.of[n];
      represented += weight;
    }
  }
  // Relative to the mean of the free cells, so that numbers stay near 1.
  result.scale = sum > 0.0 ? (1.0 - outlier) * represented / sum : 0.0;
  return result;
}

void GridFilter::update(std::span<const double> log_likelihood,
                        double exponent,
                        double burst_outlier) {
  RAYLOC_CHECK(log_likelihood.size() == space_->grid.size());
  update(log_likelihood, CellSet{}, exponent, burst_outlier);
}

void GridFilter::update(std::span<const double> log_likelihood,
                        const CellSet& cells,
                        double exponent,
                        double burst_outlier) {
  RAYLOC_CHECK(exponent >= 0.0 && !log_likelihood.empty());
  const double outlier = std::clamp(burst_outlier, motion_.outlier, 1.0);
  const Relative likelihood = relative(log_likelihood, cells, exponent, outlier);
  std::vector<float> values(window_.size(), 1.0F);
  for (std::size_t n = 0; n < likelihood.of.size(); ++n) {
    const auto at = window_.number(cells.cell(n), space_->grid);
    if (at) {
      values[*at] = static_cast<float>(likelihood.scale * likelihood.of[n] + outlier);
    }
  }
  WorkDone::add(3 * modes_.size() * values.size(), 24 * modes_.size() * values.size());
  for (Mode& mode : modes_) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      mode.mass[i] *= values[i];
    }
  }
  normalise();
}

// Mass outside the new window is added to away(); cells that enter the window are empty.
void GridFilter::take(const CellWindow& window) {
  const Grid& grid = space_->grid;
  for (Mode& mode : modes_) {
    std::vector<float> mass(window.size());
    double kept = 0.0;
    const double before = sum_of(mode.mass);
    for (std::size_t n = 0; n < mass.size(); ++n) {
      if (const auto from = window_.number(window.cell(n, grid), grid)) {
        mass[n] = mode.mass[*from];
        kept += static_cast<double>(mass[n]);
      }
    }
    away_ += std::max(0.0, before - kept);
    mode.mass = std::move(mass);
  }
  window_ = window;
}

void GridFilter::narrow(double share, Duration reach) {
  const Grid& grid = space_->grid;
  std::vector<double> by_x(window_.count_x);
  std::vector<double> by_y(window_.count_y);
  double all = 0.0;
  for (const Mode& mode : modes_) {
    for (std::size_t i = 0; i < mode.mass.size(); ++i) {
      const auto mass = static_cast<double>(mode.mass[i]);
      by_x[i / window_.count_y] += mass;
      by_y[i % window_.count_y] += mass;
      all += mass;
    }
  }
  const double fastest =
      *std::max_element(motion_.walking_speeds.begin(), motion_.walking_speeds.end());
  // Removes cells at both ends; indices are those of the room's grid.
  const auto kept = [&](const std::vector<double>& masses,
                        std::size_t first,
                        std::size_t most,
                        double step) -> std::array<std::size_t, 2> {
    // A quarter of the share may be left out on each of four sides.
    auto [begin, end] = kept_range(masses, 0.25 * share * all);
    const auto beside = static_cast<std::size_t>(std::ceil(fastest * to_seconds(reach) / step)) + 1;
    begin += first;
    end += first;
    return {begin - std::min(begin, beside), std::min(end + beside, most)};
  };
  const auto x = kept(by_x, window_.first_x, grid.count_x, grid.step_x);
  const auto y = kept(by_y, window_.first_y, grid.count_y, grid.step_y);
  const CellWindow next{x[0], y[0], x[1] - x[0], y[1] - y[0]};
  if (next.is_all_of(grid)) {
    widen();
  } else {
    take(next);
  }
}

void GridFilter::widen() {
  const Grid& grid = space_->grid;
  if (window_.is_all_of(grid)) {
    return;
  }
  const CellWindow before = window_;
  const auto is_other = [&](std::size_t cell) {
    return space_->free[cell] != 0 && !before.number(cell, grid);
  };
  double others = 0.0;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    others += is_other(cell) ? 1.0 : 0.0;
  }
  take(CellWindow::all_of(grid));
  const double each = others > 0.0 ? away_ / others : 0.0;
  const auto walks = static_cast<double>(modes_.size() - 1);
  for (Mode& mode : modes_) {
    const auto of_mode = static_cast<float>(0.5 * each / (&mode == &modes_.front() ? 1.0 : walks));
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
      mode.mass[cell] += is_other(cell) ? of_mode : 0.0F;
    }
  }
  away_ = 0.0;
  normalise();
}

void GridFilter::compact(std::size_t most, const std::vector<double>& mass) {
  if (window_.size() <= most || is_compact()) {
    return;
  }
  kept_.cells.reserve(most);
  kept_.mass.reserve(most * modes_.size());
  kept_.others.reserve(modes_.size());
  for (const std::size_t cell : highest(mass, most)) {
    kept_.cells.push_back(static_cast<std::uint32_t>(cell));
  }
  std::sort(kept_.cells.begin(), kept_.cells.end());
  const double others = std::max(0.0, free_cells() - static_cast<double>(most));
  for (Mode& mode : modes_) {
    double left = sum_of(mode.mass);
    for (const std::uint32_t cell : kept_.cells) {
      kept_.mass.push_back(mode.mass[cell]);
      left -= static_cast<double>(mode.mass[cell]);
    }
    kept_.others.push_back(others > 0.0 ? static_cast<float>(std::max(0.0, left) / others) : 0.0F);
    mode.mass = std::vector<float>();  // releases the memory
  }
}

void GridFilter::wake() {
  if (!is_compact()) {
    return;
  }
  const float* kept = kept_.mass.data();
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    std::vector<float>& mass = modes_[k].mass;
    mass.resize(window_.size());
    for (std::size_t n = 0; n < mass.size(); ++n) {
      const bool is_free = space_->free[window_.cell(n, space_->grid)] != 0;
      mass[n] = is_free ? kept_.others[k] : 0.0F;
    }
    for (const std::uint32_t cell : kept_.cells) {
      mass[cell] = *kept++;
    }
  }
  kept_ = {};
}

// Number of free cells in the window.
double GridFilter::free_cells() const {
  double count = 0.0;
  for (std::size_t n = 0; n < window_.size(); ++n) {
    count += space_->free[window_.cell(n, space_->grid)] != 0 ? 1.0 : 0.0;
  }
  return count;
}

std::vector<double> GridFilter::mass() const {
  std::vector<double> mass(window_.size());
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

std::vector<GridFilter::ModeView> GridFilter::modes() const {
  RAYLOC_CHECK(!is_compact());
  std::vector<ModeView> views;
  views.reserve(modes_.size());
  for (const Mode& mode : modes_) {
    views.push_back({mode.velocity_x, mode.velocity_y, mode.mass});
  }
  return views;
}

void GridFilter::set(const std::vector<std::vector<float>>& mass) {
  RAYLOC_CHECK(mass.size() == modes_.size());
  kept_ = {};
  window_ = CellWindow::all_of(space_->grid);
  away_ = 0.0;
  double sum = 0.0;
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    RAYLOC_CHECK(mass[k].size() == window_.size());
    modes_[k].mass = mass[k];
    for (std::size_t cell = 0; cell < window_.size(); ++cell) {
      if (space_->free[cell] == 0) {
        modes_[k].mass[cell] = 0.0F;
      }
    }
    sum += sum_of(modes_[k].mass);
  }
  RAYLOC_CHECK(sum > 0.0);
  normalise();
}

double GridFilter::stationary() const {
  return sum_of(modes_.front().mass) / std::max(1.0 - away_, kMinAway);
}

}  // namespace rayloc
