#include "engine/posterior/posterior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "engine/base/check.h"
#include "engine/posterior/cell_places.h"
#include "engine/posterior/smallest_half_mass_disc.h"
#include "engine/posterior/two_component_split.h"

namespace rayloc {
namespace {

constexpr double kKernel = 0.1;            // [m], standard deviation
constexpr double kPeakRadius = 0.15;       // [m], the position is the mean within it
constexpr double kHypothesisRadius = 0.3;  // [m], mass that belongs to one hypothesis
constexpr double kMinWeight = 0.02;        // least weight of a reported hypothesis
constexpr double kMinPart = 1e-9;          // share of a peak's mass, for a cell to be part of it
constexpr double kAmbiguousRatio = 0.3;    // weight of another place's hypothesis to the first
// Parts of one broad peak: at most this far apart [m], and at most this many of their spreads.
// Neighbouring parts are 1.5 to 2 apart, peaks with a valley between them 3 and more.
constexpr double kTouch = 0.65;
constexpr double kSpreads = 2.3;           // a ratio to the sum of both spreads
constexpr double kMaxConfidence = 0.9999;  // largest confidence with a reported radius
constexpr double kHeightSigma = 0.05;      // [m], of the assumed height
constexpr double kHeightShare = 0.5;       // of the prior's variance: below it z was estimated

// exp(likelihood_exponent * (l - max)), normalised to 1.
std::vector<double> weights_of(const std::vector<double>& log_likelihood,
                               double likelihood_exponent) {
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  std::vector<double> weights(log_likelihood.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = std::exp(likelihood_exponent * (log_likelihood[i] - top));
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

// The cell with the most mass around it, among those for which `take` holds.
template <typename Take>
std::size_t peak_of(const Grid& grid, const std::vector<double>& mass, const Take& take) {
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
  std::size_t best = smooth.size();
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    if (take(i) && (best == smooth.size() || smooth[i] > smooth[best])) {
      best = i;
    }
  }
  RAYLOC_CHECK(best < smooth.size());
  return best;
}

double horizontal_distance(const Vec3d& a, const Vec3d& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

// The posterior: masses of the cells of a grid, and their distributions inside the cells.
struct Masses {
  const Grid& grid;
  std::vector<double> mass;
  std::span<const CellMass> within;  // [cell], distribution inside the cell; empty: uniform
  CellMoments uniform;
  double sigma_floor;

  const CellMoments& moments(std::size_t i) const {
    return within.empty() ? uniform : within[i].all;
  }
  Vec3d position(std::size_t i) const {
    const CellMoments& m = moments(i);
    return grid.centre(i) + Vec3d{m.x, m.y, m.z};
  }
};

// Empty if no cell has a known distribution.
std::vector<CellMass> of_every_cell(const Grid& grid, const RefinedCells& known) {
  std::vector<CellMass> all;
  if (!known.empty()) {
    const CellMoments uniform = uniform_moments(grid);
    all.assign(grid.size(), {uniform, uniform, 1.0});
    for (const auto& [cell, mass] : known) {
      all.at(cell) = mass;
    }
  }
  return all;
}

struct Mean {
  double mass = 0.0;
  Vec3d position;
};

// Mean position of the cells for which `take` holds.
template <typename Take>
Mean mean_position(const Masses& masses, const Take& take) {
  Mean result;
  double x = 0.0;
  double y = 0.0;
  double above = 0.0;  // relative to the grid's height
  for (std::size_t i = 0; i < masses.mass.size(); ++i) {
    const double mass = masses.mass[i];
    if (mass > 0.0 && take(i)) {
      const Vec3d p = masses.position(i);
      result.mass += mass;
      x += mass * p.x;
      y += mass * p.y;
      above += mass * masses.moments(i).z;
    }
  }
  if (result.mass > 0.0) {
    result.position = {x / result.mass, y / result.mass, masses.grid.first.z + above / result.mass};
  }
  return result;
}

template <typename Take>
std::array<double, 9> covariance_about(const Masses& masses, const Vec3d& about, const Take& take) {
  double sum = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  Vec3d z;  // xz, yz, zz
  for (std::size_t i = 0; i < masses.mass.size(); ++i) {
    const double mass = masses.mass[i];
    if (mass > 0.0 && take(i)) {
      const Vec3d d = masses.position(i) - about;
      const CellMoments& m = masses.moments(i);
      sum += mass;
      xx += mass * (d.x * d.x + m.xx);
      xy += mass * (d.x * d.y + m.xy);
      yy += mass * (d.y * d.y + m.yy);
      z = z + mass * Vec3d{d.x * d.z + m.xz, d.y * d.z + m.yz, d.z * d.z + m.zz};
    }
  }
  const double least = masses.sigma_floor * masses.sigma_floor;
  const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
  const bool is_height_known = masses.grid.height_sigma <= 0.0;
  return {scale * xx + least,
          scale * xy,
          scale * z.x,
          scale * xy,
          scale * yy + least,
          scale * z.y,
          scale * z.x,
          scale * z.y,
          is_height_known ? kHeightSigma * kHeightSigma : scale * z.z + least};
}

// The radius about `centre` that holds `confidence` of the mass, widened by the spread in a cell.
double radius_of(const Masses& masses, const Vec3d& centre, double confidence, double anywhere) {
  const double of_each = anywhere / static_cast<double>(masses.mass.size());
  std::vector<std::pair<double, double>> by_distance;  // distance, mass
  double variance = masses.sigma_floor * masses.sigma_floor;
  for (std::size_t i = 0; i < masses.mass.size(); ++i) {
    const double mass = (1.0 - anywhere) * masses.mass[i] + of_each;
    if (mass > 1e-12) {
      by_distance.emplace_back(horizontal_distance(masses.position(i), centre), mass);
      const CellMoments& m = masses.moments(i);
      variance += 0.5 * mass * (m.xx + m.yy);
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
  // Radius of a circular Gaussian at that confidence.
  const double hidden = std::sqrt(-2.0 * std::log(1.0 - confidence) * variance);
  return std::hypot(radius, hidden);
}

// A small outlier probability raises the quantile read from the map. A larger one is treated as
// mass spread over the whole room.
double accuracy_of(const Masses& masses, const Vec3d& position, const PosteriorOptions& options) {
  const double of_map = options.accuracy_confidence / (1.0 - options.outlier);
  return of_map <= kMaxConfidence
             ? radius_of(masses, position, of_map, 0.0)
             : radius_of(masses, position, options.accuracy_confidence, options.outlier);
}

// Adds the mass of a cell, in two parts if its best place is known.
void add_parts(const Masses& masses, std::size_t cell, std::vector<HillMass>& parts) {
  // A ratio, chosen: a cell whose best place has at least this share is one part.
  constexpr double kOnePartShare = 1.0 - 1e-9;
  const Vec3d centre = masses.grid.centre(cell);
  const double least = masses.sigma_floor * masses.sigma_floor;
  const auto add = [&](double mass, const CellMoments& m) {
    parts.push_back({mass, centre.x + m.x, centre.y + m.y, m.xx + least, m.xy, m.yy + least});
  };
  const double mass = masses.mass[cell];
  if (masses.within.empty() || masses.within[cell].best_share > kOnePartShare) {
    add(mass, masses.moments(cell));
    return;
  }
  const CellMass& within = masses.within[cell];
  add(within.best_share * mass, within.best);
  add((1.0 - within.best_share) * mass, rest_of(within));
}

// Hypothesis of a part of the peak of `whole`; its height is that of the whole peak.
Hypothesis hypothesis_of(const HillMass& hill, const Hypothesis& whole, double inlier) {
  return {{hill.x, hill.y, whole.position.z},
          {hill.xx, hill.xy, 0.0, hill.xy, hill.yy, 0.0, 0.0, 0.0, whole.covariance[8]},
          inlier * hill.mass};
}

void sort_by_weight(std::vector<Hypothesis>& hypotheses) {
  std::stable_sort(hypotheses.begin(),
                   hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.weight > b.weight; });
}

bool touch(const Hypothesis& a, const Hypothesis& b) {
  const double x = b.position.x - a.position.x;
  const double y = b.position.y - a.position.y;
  const double apart = std::hypot(x, y);
  const auto spread = [&](const Hypothesis& one) {
    const auto& c = one.covariance;
    return std::sqrt(c[0] * x * x + 2.0 * c[1] * x * y + c[4] * y * y) / std::max(apart, 1e-9);
  };
  return apart < kTouch && apart < kSpreads * (spread(a) + spread(b));
}

// True if a place that is not connected with the first, directly or by others, is nearly as likely.
// REQUIRES: the heaviest is the first.
bool is_ambiguous(const std::vector<Hypothesis>& hypotheses) {
  if (hypotheses.empty()) {
    return false;
  }
  std::vector<Hypothesis> others(hypotheses.begin() + 1, hypotheses.end());
  std::vector<Hypothesis> same{hypotheses.front()};  // grows by the hypotheses connected with it
  for (std::size_t i = 0; i < same.size(); ++i) {
    const auto apart = std::stable_partition(
        others.begin(), others.end(), [&](const auto& one) { return !touch(same[i], one); });
    same.insert(same.end(), apart, others.end());
    others.erase(apart, others.end());
  }
  return std::any_of(others.begin(), others.end(), [&](const Hypothesis& one) {
    return one.weight > kAmbiguousRatio * hypotheses.front().weight;
  });
}

void add_hypotheses(Masses masses, const PosteriorOptions& options, LocationEstimate& estimate) {
  const double inlier = 1.0 - options.outlier;
  double left = 1.0;
  std::vector<HillMass> heaviest;  // parts of the heaviest peak
  double most = 0.0;
  while (estimate.hypotheses.size() < options.max_hypotheses) {
    const Vec3d peak =
        masses.grid.centre(peak_of(masses.grid, masses.mass, [](std::size_t) { return true; }));
    const auto near = [&](std::size_t i) {
      return horizontal_distance(masses.grid.centre(i), peak) <= kHypothesisRadius;
    };
    const Mean mean = mean_position(masses, near);
    if (mean.mass < kMinWeight) {
      break;
    }
    estimate.hypotheses.push_back(
        {mean.position, covariance_about(masses, mean.position, near), inlier * mean.mass});
    left -= inlier * mean.mass;
    const bool is_heaviest = mean.mass > most;
    if (is_heaviest) {
      most = mean.mass;
      heaviest.clear();
    }
    for (std::size_t i = 0; i < masses.mass.size(); ++i) {
      if (near(i)) {
        if (is_heaviest && masses.mass[i] > kMinPart * mean.mass) {
          add_parts(masses, i, heaviest);
        }
        masses.mass[i] = 0.0;
      }
    }
  }
  estimate.residual_probability = std::clamp(left, 0.0, 1.0);
  std::vector<Hypothesis>& hypotheses = estimate.hypotheses;
  sort_by_weight(hypotheses);
  estimate.ambiguous = is_ambiguous(hypotheses);
  if (hypotheses.empty() || hypotheses.size() >= options.max_hypotheses) {
    return;
  }
  if (const auto two = two_component_split(heaviest)) {
    const Hypothesis whole = hypotheses.front();
    hypotheses.front() = hypothesis_of((*two)[0], whole, inlier);
    hypotheses.push_back(hypothesis_of((*two)[1], whole, inlier));
    sort_by_weight(hypotheses);
  }
}

}  // namespace

double effective_cells(std::span<const double> mass) {
  double entropy = 0.0;
  for (const double m : mass) {
    if (m > 0.0) {
      entropy -= m * std::log(m);
    }
  }
  return std::exp(entropy);
}

void summarise_posterior(const Grid& grid,
                         const std::vector<double>& log_likelihood,
                         const PosteriorOptions& options,
                         LocationEstimate& estimate,
                         const RefinedCells& within) {
  RAYLOC_CHECK(log_likelihood.size() == grid.size());
  const std::vector<CellMass> of_cells = of_every_cell(grid, within);
  const Masses masses{grid,
                      weights_of(log_likelihood, options.likelihood_exponent),
                      of_cells,
                      uniform_moments(grid),
                      options.sigma_floor};
  const double cells = std::max(static_cast<double>(grid.size()), options.cells_of_room);
  if (effective_cells(masses.mass) > options.max_spread * cells) {
    estimate.reason = "the likelihood is flat: the frames fit everywhere in the room";
    return;
  }
  const Disc half = smallest_half_mass_disc(grid, masses.mass, kPeakRadius);
  const Vec3d peak = grid.centre(
      peak_of(grid, masses.mass, [&](std::size_t i) { return half.contains(grid.centre(i)); }));
  const auto near = [&](std::size_t i) {
    return horizontal_distance(grid.centre(i), peak) <= kPeakRadius;
  };
  const Vec3d position = mean_position(masses, near).position;
  Masses stated = masses;
  if (options.region_exponent != 1.0) {
    stated.mass = weights_of(log_likelihood, options.likelihood_exponent * options.region_exponent);
  }
  estimate.position = position;
  estimate.covariance = covariance_about(stated, position, [](std::size_t) { return true; });
  estimate.is_height_estimated =
      grid.height_sigma > 0.0 &&
      estimate.covariance[8] < kHeightShare * grid.height_sigma * grid.height_sigma;
  estimate.accuracy_confidence = options.accuracy_confidence;
  estimate.accuracy_m = accuracy_of(stated, position, options);
  add_hypotheses(std::move(stated), options, estimate);
  double top = log_likelihood.front();
  bool found = false;
  for (std::size_t i = 0; i < masses.mass.size(); ++i) {
    if (near(i) && (!found || log_likelihood[i] > top)) {
      top = log_likelihood[i];
      found = true;
    }
  }
  estimate.loss = -top;
}

}  // namespace rayloc
