#include "daemon/pipeline/zones/gaussian_in_polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Point = std::array<double, 2>;

constexpr double kMinDeviation = 1e-4;  // [m]
// Beyond this many deviations there is less than 1e-15 of a normal distribution.
constexpr double kFar = 8.0;
// Nodes and weights of the Gauss-Legendre rule with eight points, one half; the other mirrors it.
constexpr std::array<double, 4> kNodes = {
    0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
// The weights of kNodes, in the same order.
constexpr std::array<double, 4> kWeights = {
    0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
// Longest piece of an edge for one rule, in deviations: an error of 1e-11 each.
constexpr double kPiece = 1.0;

double normal_density(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
}
double normal_below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

Point between(const Point& a, const Point& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
}

// Integral of density(y) * below(x) dy along a - b, by quadrature.
double along_smooth(const Point& a, const Point& b) {
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  const double pieces = std::max(1.0, std::ceil(length / kPiece));
  double sum = 0.0;
  for (int piece = 0; piece < static_cast<int>(pieces); ++piece) {
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      for (const double sign : {-1.0, 1.0}) {
        const Point p = between(a, b, (piece + 0.5 + 0.5 * sign * kNodes.at(i)) / pieces);
        sum += kWeights.at(i) * normal_density(p[1]) * normal_below(p[0]);
      }
    }
  }
  return 0.5 * sum * (b[1] - a[1]) / pieces;
}

// Cuts [low, high] of a - b where the coordinate `axis` lies within +-kFar.
void keep_near(const Point& a, const Point& b, std::size_t axis, double& low, double& high) {
  const double step = b.at(axis) - a.at(axis);
  if (step == 0.0) {
    return;
  }
  const double first = (-kFar - a.at(axis)) / step;
  const double second = (kFar - a.at(axis)) / step;
  low = std::clamp(std::min(first, second), low, high);
  high = std::clamp(std::max(first, second), low, high);
}

// The same integral for any edge. It vanishes far to the left; far to the right `below` is 1; far
// above and below the density is 0. The remainder is short, and smooth on the scale of 1.
double along(const Point& a, const Point& b) {
  double low = 0.0;
  double high = 1.0;
  if (std::abs(a[1]) > kFar || std::abs(b[1]) > kFar) {
    if (std::min(a[1], b[1]) > kFar || std::max(a[1], b[1]) < -kFar) {
      return 0.0;
    }
    keep_near(a, b, 1, low, high);
  }
  const Point from = between(a, b, low);
  const Point to = between(a, b, high);
  if (std::max(from[0], to[0]) < -kFar) {
    return 0.0;
  }
  if (std::min(from[0], to[0]) > kFar) {
    return normal_below(to[1]) - normal_below(from[1]);
  }
  low = 0.0;
  high = 1.0;
  keep_near(from, to, 0, low, high);
  const Point near_from = between(from, to, low);
  const Point near_to = between(from, to, high);
  double sum = along_smooth(near_from, near_to);
  if (from[0] > kFar) {
    sum += normal_below(near_from[1]) - normal_below(from[1]);
  }
  if (to[0] > kFar) {
    sum += normal_below(to[1]) - normal_below(near_to[1]);
  }
  return sum;
}

}  // namespace

// In coordinates in which the distribution is standard normal, Green's theorem turns the integral
// over the polygon into one along its edges: of density(y) * below(x) dy.
double gaussian_in_polygon(const PlanarGaussian& gaussian, std::span<const Point> corners) {
  RAYLOC_CHECK(corners.size() >= 3);
  constexpr double kMinVariance = kMinDeviation * kMinDeviation;  // [m^2], of kMinDeviation
  const double deviation_x = std::sqrt(std::max(gaussian.variance_x, kMinVariance));
  const double slope = gaussian.covariance_xy / deviation_x;
  const double deviation_y = std::sqrt(std::max(gaussian.variance_y - slope * slope, kMinVariance));
  const auto standard = [&](const Point& p) {
    const double u = (p[0] - gaussian.mean[0]) / deviation_x;
    return Point{u, (p[1] - gaussian.mean[1] - slope * u) / deviation_y};
  };
  double sum = 0.0;
  Point previous = standard(corners.back());
  for (const Point& corner : corners) {
    const Point next = standard(corner);
    sum += along(previous, next);
    previous = next;
  }
  return std::clamp(std::abs(sum), 0.0, 1.0);
}

}  // namespace rayloc
