#include "engine/localize/posterior.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr double kKernel = 0.1;            // [m], standard deviation
constexpr double kPeakRadius = 0.15;       // [m], the position is the mean within it
constexpr double kHypothesisRadius = 0.3;  // [m], mass that belongs to one hypothesis
constexpr double kLeastWeight = 0.02;      // of a hypothesis worth stating
constexpr double kAmbiguousRatio = 0.3;    // weight of the second hypothesis to the first
constexpr double kMostSpread = 0.5;        // of the room's area: past that the map is flat
// Survey of the access points and of the plan, left in every estimate [m].
constexpr double kLeastSigma = 0.01;
constexpr double kHeightSigma = 0.05;  // [m], of the assumed height

// exp(temper * (l - max)), normalised to 1.
std::vector<double> weights_of(const std::vector<double>& log_likelihood, double temper) {
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  std::vector<double> weights(log_likelihood.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = std::exp(temper * (log_likelihood[i] - top));
    sum += weights[i];
  }
  for (double& weight : weights) {
    weight /= sum;
  }
  return weights;
}

std::vector<double> kernel_of(double step) {
  std::vector<double> kernel;
  for (std::size_t i = 0; static_cast<double>(i) * step <= 3.0 * kKernel; ++i) {
    const double x = static_cast<double>(i) * step / kKernel;
    kernel.push_back(std::exp(-0.5 * x * x));
  }
  return kernel;
}

// One pass of a separable smoothing along a line of `count` values `stride` apart.
void smooth_line(const std::vector<double>& in,
                 std::vector<double>& out,
                 std::size_t begin,
                 std::size_t stride,
                 std::size_t count,
                 const std::vector<double>& kernel) {
  for (std::size_t i = 0; i < count; ++i) {
    double sum = kernel[0] * in[begin + i * stride];
    for (std::size_t k = 1; k < kernel.size(); ++k) {
      if (i >= k) {
        sum += kernel[k] * in[begin + (i - k) * stride];
      }
      if (i + k < count) {
        sum += kernel[k] * in[begin + (i + k) * stride];
      }
    }
    out[begin + i * stride] = sum;
  }
}

std::size_t peak_of(const RoomGrid& grid, const std::vector<double>& mass) {
  std::vector<double> half(mass.size());
  std::vector<double> smooth(mass.size());
  const auto kernel_x = kernel_of(grid.step_x);
  const auto kernel_y = kernel_of(grid.step_y);
  for (std::size_t x = 0; x < grid.count_x; ++x) {
    smooth_line(mass, half, x * grid.count_y, 1, grid.count_y, kernel_y);
  }
  for (std::size_t y = 0; y < grid.count_y; ++y) {
    smooth_line(half, smooth, y, grid.count_y, grid.count_x, kernel_x);
  }
  return static_cast<std::size_t>(std::max_element(smooth.begin(), smooth.end()) - smooth.begin());
}

double horizontal_distance(const Vec3d& a, const Vec3d& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

struct Moments {
  double mass = 0.0;
  Vec3d mean;
  std::array<double, 9> covariance{};  // about `mean`, or about what was asked for
};

// Second moments about `about` of the cells for which `take` holds.
template <typename Take>
Moments moments_of(const RoomGrid& grid, const std::vector<double>& mass, const Take& take) {
  Moments result;
  double x = 0.0;
  double y = 0.0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (mass[i] > 0.0 && take(i)) {
      const Vec3d p = grid.centre(i);
      result.mass += mass[i];
      x += mass[i] * p.x;
      y += mass[i] * p.y;
    }
  }
  if (result.mass > 0.0) {
    result.mean = {x / result.mass, y / result.mass, grid.first.z};
  }
  return result;
}

template <typename Take>
std::array<double, 9> covariance_about(const RoomGrid& grid,
                                       const std::vector<double>& mass,
                                       const Vec3d& about,
                                       const Take& take) {
  double sum = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (mass[i] > 0.0 && take(i)) {
      const Vec3d d = grid.centre(i) - about;
      sum += mass[i];
      xx += mass[i] * d.x * d.x;
      xy += mass[i] * d.x * d.y;
      yy += mass[i] * d.y * d.y;
    }
  }
  const double least = kLeastSigma * kLeastSigma;
  const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
  return {scale * xx + grid.step_x * grid.step_x / 12.0 + least,
          scale * xy,
          0.0,
          scale * xy,
          scale * yy + grid.step_y * grid.step_y / 12.0 + least,
          0.0,
          0.0,
          0.0,
          kHeightSigma * kHeightSigma};
}

// The radius about `centre` that holds `confidence` of the mass, widened by what a cell hides.
double radius_of(const RoomGrid& grid,
                 const std::vector<double>& mass,
                 const Vec3d& centre,
                 double confidence) {
  std::vector<std::pair<double, double>> by_distance;  // distance, mass
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (mass[i] > 1e-12) {
      by_distance.emplace_back(horizontal_distance(grid.centre(i), centre), mass[i]);
    }
  }
  std::sort(by_distance.begin(), by_distance.end());
  double inside = 0.0;
  double radius = 0.0;
  for (const auto& [distance, weight] : by_distance) {
    inside += weight;
    radius = distance;
    if (inside >= confidence) {
      break;
    }
  }
  const double variance =
      (grid.step_x * grid.step_x + grid.step_y * grid.step_y) / 24.0 + kLeastSigma * kLeastSigma;
  // Radius of a circular Gaussian at that confidence.
  const double hidden = std::sqrt(-2.0 * std::log(1.0 - confidence) * variance);
  return std::hypot(radius, hidden);
}

double effective_cells(const std::vector<double>& mass) {
  double entropy = 0.0;
  for (const double m : mass) {
    if (m > 0.0) {
      entropy -= m * std::log(m);
    }
  }
  return std::exp(entropy);
}

void add_hypotheses(const RoomGrid& grid,
                    std::vector<double> mass,
                    std::size_t most,
                    LocationEstimate& estimate) {
  double left = 1.0;
  while (estimate.hypotheses.size() < most) {
    const Vec3d peak = grid.centre(peak_of(grid, mass));
    const auto near = [&](std::size_t i) {
      return horizontal_distance(grid.centre(i), peak) <= kHypothesisRadius;
    };
    const Moments moments = moments_of(grid, mass, near);
    if (moments.mass < kLeastWeight) {
      break;
    }
    estimate.hypotheses.push_back(
        {moments.mean, covariance_about(grid, mass, moments.mean, near), moments.mass});
    left -= moments.mass;
    for (std::size_t i = 0; i < mass.size(); ++i) {
      if (near(i)) {
        mass[i] = 0.0;
      }
    }
  }
  std::stable_sort(estimate.hypotheses.begin(),
                   estimate.hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.weight > b.weight; });
  estimate.residual_probability = std::clamp(left, 0.0, 1.0);
}

}  // namespace

RoomGrid::RoomGrid(const Vec3d& bounds_min, const Vec3d& bounds_max, double height, double step) {
  const double width_x = bounds_max.x - bounds_min.x;
  const double width_y = bounds_max.y - bounds_min.y;
  RAYLOC_CHECK(width_x > 0.0 && width_y > 0.0 && step > 0.0);
  count_x = static_cast<std::size_t>(std::ceil(width_x / step));
  count_y = static_cast<std::size_t>(std::ceil(width_y / step));
  step_x = width_x / static_cast<double>(count_x);
  step_y = width_y / static_cast<double>(count_y);
  first = {bounds_min.x + 0.5 * step_x, bounds_min.y + 0.5 * step_y, height};
}

void summarise_posterior(const RoomGrid& grid,
                         const std::vector<double>& log_likelihood,
                         const PosteriorOptions& options,
                         LocationEstimate& estimate) {
  RAYLOC_CHECK(log_likelihood.size() == grid.size());
  const auto mass = weights_of(log_likelihood, options.temper);
  if (effective_cells(mass) > kMostSpread * static_cast<double>(grid.size())) {
    estimate.reason = "the likelihood is flat: the frames fit everywhere in the room";
    return;
  }
  const Vec3d peak = grid.centre(peak_of(grid, mass));
  const auto near = [&](std::size_t i) {
    return horizontal_distance(grid.centre(i), peak) <= kPeakRadius;
  };
  const Vec3d position = moments_of(grid, mass, near).mean;
  estimate.position = position;
  estimate.covariance = covariance_about(grid, mass, position, [](std::size_t) { return true; });
  estimate.accuracy_confidence = options.accuracy_confidence;
  estimate.accuracy_m = radius_of(grid, mass, position, options.accuracy_confidence);
  add_hypotheses(grid, mass, options.max_hypotheses, estimate);
  estimate.ambiguous =
      estimate.hypotheses.size() > 1 &&
      estimate.hypotheses[1].weight > kAmbiguousRatio * estimate.hypotheses[0].weight;
  double top = log_likelihood.front();
  bool found = false;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (near(i) && (!found || log_likelihood[i] > top)) {
      top = log_likelihood[i];
      found = true;
    }
  }
  estimate.loss = -top;
}

}  // namespace rayloc
