#include "engine/em/cylinder_boundary.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "engine/em/cylinder_bessel.h"

namespace rayloc {
namespace {

using C = Complex<double>;
using Scalar = std::complex<double>;

// Smaller semi-axis of the sources' ellipse, over that of the boundary.
constexpr double kSourceDepth = 0.7;

Scalar boundary_scalar(const C& z) { return {z.re, z.im}; }
Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

double midpoint(std::size_t i, std::size_t count) {
  return std::numbers::pi / 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
}

// The sign of a function of that symmetry at the mirror image `i` of a point: bit 0, x is mirrored;
// bit 1, y.
double image_sign(const Symmetry& symmetry, std::size_t i) {
  const double by_y = symmetry.harmonic == Harmonic::kCosine ? 1.0 : -1.0;
  const double by_x = symmetry.odd ? -by_y : by_y;
  return ((i & 1) != 0 ? by_x : 1.0) * ((i & 2) != 0 ? by_y : 1.0);
}

}  // namespace

Angular angular(const Symmetry& symmetry, std::size_t order, double angle) {
  const auto n = static_cast<double>(order);
  const double c = std::cos(n * angle);
  const double s = std::sin(n * angle);
  return symmetry.harmonic == Harmonic::kCosine ? Angular{c, -n * s} : Angular{s, n * c};
}

Family::Family(std::size_t points, std::size_t functions)
    : value(index(points), index(functions)),
      across(index(points), index(functions)),
      along(index(points), index(functions)) {}

EllipseQuarter::EllipseQuarter(const std::array<double, 2>& semi_axes, std::size_t points)
    : semi_axes_(semi_axes), points_(points) {
  const auto [a, b] = semi_axes;
  for (std::size_t i = 0; i < points; ++i) {
    Point& p = points_[i];
    p.t = midpoint(i, points);
    const double c = std::cos(p.t);
    const double s = std::sin(p.t);
    p.x = a * c;
    p.y = b * s;
    p.radius = std::hypot(p.x, p.y);
    p.azimuth = std::atan2(p.y, p.x);
    p.radial = a * b / p.radius;
    p.azimuthal = (a * a - b * b) * s * c / p.radius;
    p.speed = std::hypot(a * s, b * c);
    p.curvature = a * b / (p.speed * p.speed * p.speed);
  }
}

Family EllipseQuarter::regular_waves(const C& wavenumber,
                                     const Symmetry& symmetry,
                                     std::size_t count) const {
  Family family(points_.size(), count);
  std::vector<C> bessel(symmetry.order(count - 1) + 2);
  const double reach = std::max(semi_axes_[0], semi_axes_[1]);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& p = points_[i];
    scaled_bessel_orders({p.radius * wavenumber.re, p.radius * wavenumber.im}, bessel);
    const double scale = std::exp(wavenumber.im * (reach - p.radius));
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t n = symmetry.order(k);
      const Angular a = angular(symmetry, n, p.azimuth);
      const Scalar value = scale * boundary_scalar(bessel[n]);
      const Scalar slope = (static_cast<double>(n) / p.radius) * value -
                           scale * boundary_scalar(wavenumber * bessel[n + 1]);
      const Scalar by_radius = a.value * slope;
      const Scalar by_azimuth = (a.slope / p.radius) * value;
      family.value(index(i), index(k)) = a.value * value;
      family.across(index(i), index(k)) = p.radial * by_radius + p.azimuthal * by_azimuth;
      family.along(index(i), index(k)) = p.radial * by_azimuth - p.azimuthal * by_radius;
    }
  }
  return family;
}

Family EllipseQuarter::entering_waves(const C& wavenumber,
                                      const Symmetry& symmetry,
                                      std::size_t count) const {
  Family family(points_.size(), count);
  const C k2 = wavenumber * wavenumber;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& p = points_[i];
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t n = symmetry.order(k);
      const double along = static_cast<double>(n) / p.speed;
      const C across2 = k2 - C{along * along, 0.0};
      // Growing outwards; like J_n at a large argument, with the local radius of curvature.
      const Scalar slope = boundary_scalar(C{0.0, 1.0} * sqrt(across2)) -
                           0.5 * p.curvature * boundary_scalar(k2 / across2);
      const Angular a = angular(symmetry, n, p.t);
      family.value(index(i), index(k)) = a.value;
      family.across(index(i), index(k)) = p.speed * a.value * slope;
      family.along(index(i), index(k)) = a.slope;
    }
  }
  return family;
}

InnerSources::InnerSources(const EllipseQuarter& boundary, double wavenumber, std::size_t count)
    : wavenumber_(wavenumber),
      images_{Family(boundary.size(), count),
              Family(boundary.size(), count),
              Family(boundary.size(), count),
              Family(boundary.size(), count)} {
  const auto [a, b] = boundary.semi_axes_;
  // Both squares reduced by the same amount: confocal.
  const double less = (1.0 - kSourceDepth * kSourceDepth) * std::min(a * a, b * b);
  for (std::size_t q = 0; q < count; ++q) {
    x_.push_back(std::sqrt(a * a - less) * std::cos(midpoint(q, count)));
    y_.push_back(std::sqrt(b * b - less) * std::sin(midpoint(q, count)));
  }
  std::array<C, 2> h;
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const EllipseQuarter::Point& p = boundary.points_[i];
    for (std::size_t q = 0; q < count; ++q) {
      for (std::size_t image = 0; image < images_.size(); ++image) {
        const double dx = p.x - ((image & 1) != 0 ? -x_[q] : x_[q]);
        const double dy = p.y - ((image & 2) != 0 ? -y_[q] : y_[q]);
        const double distance = std::hypot(dx, dy);
        hankel_orders(wavenumber * distance, h);
        const Scalar slope = (-wavenumber / distance) * boundary_scalar(h[1]);
        // The tangent times ds/dt is (-a sin t, b cos t).
        const double tx = -a / b * p.y;
        const double ty = b / a * p.x;
        Family& family = images_[image];
        family.value(index(i), index(q)) = boundary_scalar(h[0]);
        family.across(index(i), index(q)) = (dx * ty - dy * tx) * slope;
        family.along(index(i), index(q)) = (dx * tx + dy * ty) * slope;
      }
    }
  }
}

Family InnerSources::waves(const Symmetry& symmetry) const {
  Family sum = images_[0];
  for (std::size_t image = 1; image < images_.size(); ++image) {
    const double sign = image_sign(symmetry, image);
    sum.value += sign * images_[image].value;
    sum.across += sign * images_[image].across;
    sum.along += sign * images_[image].along;
  }
  return sum;
}

Eigen::MatrixXcd InnerSources::incoming(const Symmetry& symmetry) const {
  const std::size_t count = x_.size();
  Eigen::MatrixXcd waves(index(count), index(count));
  std::vector<double> bessel(symmetry.order(count - 1) + 2);
  for (std::size_t q = 0; q < count; ++q) {
    bessel_orders(wavenumber_ * std::hypot(x_[q], y_[q]), bessel);
    const double azimuth = std::atan2(y_[q], x_[q]);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t n = symmetry.order(k);
      const double norm = n == 0 ? 1.0 : std::numbers::sqrt2;
      waves(index(q), index(k)) = 4.0 * norm * bessel[n] * angular(symmetry, n, azimuth).value;
    }
  }
  return waves;
}

}  // namespace rayloc
