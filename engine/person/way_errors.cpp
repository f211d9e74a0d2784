#include "engine/person/way_errors.h"

#include <algorithm>
#include <cmath>

#include "engine/person/triangle.h"

namespace rayloc {

using Value = std::complex<double>;

WayErrors::WayErrors(std::size_t antennas, std::size_t numbers)
    : antennas_(antennas), numbers_(numbers) {}

void WayErrors::add(std::size_t antenna,
                    const ScatteredRay& ray,
                    Value field,
                    std::span<const Value> s,
                    double unknown) {
  while (ray.way >= ways_.size()) {
    const Values none(antennas_ * numbers_);
    const std::vector<double> zero(antennas_);
    ways_.push_back({none, none, zero, zero, zero});
  }
  Way& way = ways_[ray.way];
  const double share = std::sqrt(unknown);
  for (std::size_t c = 0; c < numbers_; ++c) {
    const Value value = field * s[c];
    way.all[antenna * numbers_ + c] += value;
    way.unknown[antenna * numbers_ + c] += share * value;
  }
  // The phase slopes of two rays of one antenna are averaged, weighted by power.
  const double power = std::norm(field);
  const double sum = way.power[antenna] + power;
  if (sum > 0.0) {
    way.turn_x[antenna] += power / sum * (ray.slope_x.imag() - way.turn_x[antenna]);
    way.turn_y[antenna] += power / sum * (ray.slope_y.imag() - way.turn_y[antenna]);
  }
  way.power[antenna] = sum;
}

WayErrors::Values WayErrors::covariance(Values Way::*part, double sigma) const {
  Values triangle(triangle_size(antennas_ * numbers_));
  for (const Way& way : ways_) {
    const Values& g = way.*part;
    for (std::size_t m = 0; m < antennas_; ++m) {
      for (std::size_t n = 0; n <= m; ++n) {
        const double x = sigma * (way.turn_x[m] - way.turn_x[n]);
        const double y = sigma * (way.turn_y[m] - way.turn_y[n]);
        const double coherence = std::exp(-0.5 * (x * x + y * y));
        for (std::size_t i = m * numbers_; i < (m + 1) * numbers_; ++i) {
          const Value left = coherence * g[i];
          const std::size_t end = std::min(i + 1, (n + 1) * numbers_);
          for (std::size_t j = n * numbers_; j < end; ++j) {
            triangle[triangle_size(i) + j] += left * std::conj(g[j]);
          }
        }
      }
    }
  }
  return triangle;
}

WayErrors::Values WayErrors::all(double sigma) const { return covariance(&Way::all, sigma); }

WayErrors::Values WayErrors::without_phase(double sigma) const {
  return covariance(&Way::unknown, sigma);
}

}  // namespace rayloc
