#include "engine/person/path_errors.h"

#include <algorithm>
#include <cmath>

#include "engine/person/triangle.h"

namespace rayloc {

using Value = std::complex<double>;

PathErrors::PathErrors(std::size_t antennas, std::size_t numbers)
    : antennas_(antennas), numbers_(numbers) {}

void PathErrors::add(std::size_t antenna,
                     const ScatteredRay& ray,
                     Value field,
                     std::span<const Value> s,
                     double unknown) {
  while (ray.path >= paths_.size()) {
    const Values none(antennas_ * numbers_);
    const std::vector<double> zero(antennas_);
    paths_.push_back({none, none, zero, zero, zero});
  }
  PathSum& path = paths_[ray.path];
  const double share = std::sqrt(unknown);
  for (std::size_t c = 0; c < numbers_; ++c) {
    const Value value = field * s[c];
    path.all[antenna * numbers_ + c] += value;
    path.unknown[antenna * numbers_ + c] += share * value;
  }
  // The phase slopes of two rays of one antenna are averaged, weighted by power.
  const double power = std::norm(field);
  const double sum = path.power[antenna] + power;
  if (sum > 0.0) {
    path.turn_x[antenna] += power / sum * (ray.slope_x.imag() - path.turn_x[antenna]);
    path.turn_y[antenna] += power / sum * (ray.slope_y.imag() - path.turn_y[antenna]);
  }
  path.power[antenna] = sum;
}

PathErrors::Values PathErrors::covariance(Values PathSum::*part, double sigma) const {
  Values triangle(triangle_size(antennas_ * numbers_));
  for (const PathSum& path : paths_) {
    const Values& g = path.*part;
    for (std::size_t m = 0; m < antennas_; ++m) {
      for (std::size_t n = 0; n <= m; ++n) {
        const double x = sigma * (path.turn_x[m] - path.turn_x[n]);
        const double y = sigma * (path.turn_y[m] - path.turn_y[n]);
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

PathErrors::Values PathErrors::all(double sigma) const { return covariance(&PathSum::all, sigma); }

PathErrors::Values PathErrors::without_phase(double sigma) const {
  return covariance(&PathSum::unknown, sigma);
}

}  // namespace rayloc
