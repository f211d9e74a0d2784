#include "engine/paper/delay.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/check.h"

namespace rayloc::paper {
namespace {

using Value = std::complex<double>;

int least_step(const OfdmGrid& grid) {
  RAYLOC_CHECK(grid.size() >= 2);
  int step = grid.tone_index[1] - grid.tone_index[0];
  for (std::size_t k = 1; k + 1 < grid.size(); ++k) {
    step = std::min(step, grid.tone_index[k + 1] - grid.tone_index[k]);
  }
  return step;
}

std::vector<std::size_t> neighbours(const OfdmGrid& grid) {
  const int step = least_step(grid);
  std::vector<std::size_t> lower;
  for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
    if (grid.tone_index[k + 1] - grid.tone_index[k] == step) {
      lower.push_back(k);
    }
  }
  return lower;
}

std::vector<double> pair_numbers(const OfdmGrid& grid, std::span<const std::size_t> lower) {
  std::vector<double> position;
  for (const std::size_t k : lower) {
    position.push_back(grid.tone_index[k]);
  }
  return position;
}

}  // namespace

Delay::Delay(const OfdmGrid& grid, const SavitzkyGolayOptions& smoothing, double floor)
    : grid_(grid),
      floor_(floor),
      lower_(neighbours(grid)),
      slope_(-1.0 / (2.0 * std::numbers::pi * grid.spacing_hz * least_step(grid))),
      smoother_(pair_numbers(grid, lower_), smoothing) {
  RAYLOC_CHECK(floor > 0.0);
}

Delay::Values Delay::without_line_of_sight(std::span<const Value> row, double delay) const {
  Values s(row.begin(), row.end());
  for (std::size_t k = 0; k < s.size(); ++k) {
    // A phase common to all tones does not change a slope: only offsets from the centre matter.
    s[k] *= std::polar(1.0, 2.0 * std::numbers::pi * grid_.offset_hz(k) * delay);
  }
  return s;
}

Delay::Values Delay::smooth_products(std::span<const Value> s) const {
  Values product;
  product.reserve(lower_.size());
  for (const std::size_t k : lower_) {
    product.push_back(s[k + 1] * std::conj(s[k]));
  }
  return smoother_.smooth(product);
}

double Delay::least(std::span<const Value> row) const {
  double sum = 0.0;
  for (const Value& v : row) {
    sum += std::norm(v);
  }
  return floor_ * sum / static_cast<double>(row.size());
}

Delay::Anchor Delay::anchor(std::span<const Value> measured,
                            std::vector<double> line_of_sight) const {
  const std::size_t tones = grid_.size();
  RAYLOC_CHECK(measured.size() == line_of_sight.size() * tones);
  Anchor result{std::move(line_of_sight), {}};
  double sum = 0.0;
  for (std::size_t antenna = 0; antenna < result.line_of_sight.size(); ++antenna) {
    const auto row = measured.subspan(antenna * tones, tones);
    for (const Value& c :
         smooth_products(without_line_of_sight(row, result.line_of_sight[antenna]))) {
      result.weight.push_back(std::abs(c));
      sum += result.weight.back();
    }
  }
  for (double& weight : result.weight) {
    weight = sum > 0.0 ? weight / sum : 1.0 / static_cast<double>(result.weight.size());
  }
  return result;
}

std::vector<double> Delay::of(std::span<const Value> h, const Anchor& anchor) const {
  const std::size_t tones = grid_.size();
  RAYLOC_CHECK(h.size() == anchor.line_of_sight.size() * tones);
  std::vector<double> delay;
  double mean = 0.0;
  for (std::size_t antenna = 0; antenna < anchor.line_of_sight.size(); ++antenna) {
    const auto row = h.subspan(antenna * tones, tones);
    const double line_of_sight = anchor.line_of_sight[antenna];
    const double floor = least(row);
    for (const Value& c : smooth_products(without_line_of_sight(row, line_of_sight))) {
      const double excess = slope_ * std::atan2(c.imag(), c.real() + floor);
      mean += anchor.weight[delay.size()] * excess;
      delay.push_back(line_of_sight + excess);
    }
  }
  for (double& value : delay) {
    value -= mean;
  }
  return delay;
}

std::vector<Value> Delay::adjoint(std::span<const Value> h,
                                  const Anchor& anchor,
                                  std::span<const double> delay_adjoint) const {
  const std::size_t tones = grid_.size();
  const std::size_t pairs = lower_.size();
  RAYLOC_CHECK(h.size() == anchor.line_of_sight.size() * tones);
  RAYLOC_CHECK(delay_adjoint.size() == anchor.line_of_sight.size() * pairs);
  double by_mean = 0.0;
  for (const double value : delay_adjoint) {
    by_mean -= value;
  }
  Values adjoint;
  adjoint.reserve(h.size());
  for (std::size_t antenna = 0; antenna < anchor.line_of_sight.size(); ++antenna) {
    const auto row = h.subspan(antenna * tones, tones);
    const auto s = without_line_of_sight(row, anchor.line_of_sight[antenna]);
    const auto product = smooth_products(s);
    const double floor = least(row);
    Values by_product(pairs);
    double by_floor = 0.0;
    for (std::size_t i = 0; i < pairs; ++i) {
      const std::size_t at = antenna * pairs + i;
      const double by_angle = slope_ * (delay_adjoint[at] + anchor.weight[at] * by_mean);
      const double x = product[i].real() + floor;
      const double y = product[i].imag();
      const double square = x * x + y * y;
      if (square > 0.0) {
        by_product[i] = {-by_angle * y / square, by_angle * x / square};
        by_floor += by_product[i].real();
      }
    }
    const Values back = smoother_.adjoint(by_product);
    Values by_s(tones);
    for (std::size_t i = 0; i < pairs; ++i) {
      const std::size_t k = lower_[i];
      by_s[k + 1] += back[i] * s[k];
      by_s[k] += std::conj(back[i]) * s[k + 1];
    }
    // The phase rotation by the line of sight is undone by its inverse.
    const Values by_row = without_line_of_sight(by_s, -anchor.line_of_sight[antenna]);
    const double by_square = floor_ * by_floor / static_cast<double>(tones);
    for (std::size_t k = 0; k < tones; ++k) {
      adjoint.push_back(by_row[k] + 2.0 * by_square * row[k]);
    }
  }
  return adjoint;
}

}  // namespace rayloc::paper
