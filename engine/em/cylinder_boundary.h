// The boundary of an elliptic cross-section, and families of functions on it, from which the
// transition matrix (cylinder_tmatrix.h) is assembled.
//
// Lengths are times the wavenumber of free space. The two mirror planes sort functions into
// four kinds, so a quarter of the ellipse is sufficient: integrals over the boundary are sums
// over its points up to a common factor (midpoint rule in the ellipse's parameter, which
// converges exponentially).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "engine/base/complex.h"

namespace rayloc {

enum class Harmonic { kCosine, kSine };

// Functions like cos(n phi) or sin(n phi) with all even or all odd n > 0, n = 0 only as a cosine.
struct Symmetry {
  Harmonic harmonic = Harmonic::kCosine;
  bool odd = false;

  // The order n of function k = 0, 1, ... of this kind.
  std::size_t order(std::size_t k) const {
    return 2 * k + (odd ? 1 : (harmonic == Harmonic::kSine ? 2 : 0));
  }
  // Symmetry of the derivative along the boundary.
  Symmetry across() const {
    return {harmonic == Harmonic::kCosine ? Harmonic::kSine : Harmonic::kCosine, odd};
  }
};

// cos(n angle) or sin(n angle), and its derivative by the angle.
struct Angular {
  double value, slope;
};
Angular angular(const Symmetry& symmetry, std::size_t order, double angle);

// Functions (columns) at the points (rows): values, and derivatives across (outwards) and along the
// boundary, times the length ds/dt of a point.
struct Family {
  Eigen::MatrixXcd value, across, along;

  Family(std::size_t points, std::size_t functions);
};

class EllipseQuarter {
 public:
  EllipseQuarter(const std::array<double, 2>& semi_axes, std::size_t points);

  std::size_t size() const { return points_.size(); }

  // J_n(wavenumber rho) cos(n phi) or sin(n phi); wavenumber over that of free space, Im <= 0. All
  // are scaled by one factor against overflow.
  Family regular_waves(const Complex<double>& wavenumber,
                       const Symmetry& symmetry,
                       std::size_t count) const;

  // Functions for an interior from which no entering wave returns: cos(n t) or sin(n t), with the
  // normal slope of a wave that travels straight inwards: that of a plane surface, and the first
  // correction by curvature.
  Family entering_waves(const Complex<double>& wavenumber,
                        const Symmetry& symmetry,
                        std::size_t count) const;

 private:
  friend class InnerSources;

  // Components along rho and phi are those of the normal times ds/dt; those of the tangent are
  // (-azimuthal, radial).
  struct Point {
    double t = 0.0;  // (a cos t, b sin t)
    double x = 0.0;
    double y = 0.0;
    double radius = 0.0;
    double azimuth = 0.0;
    double radial = 0.0;
    double azimuthal = 0.0;
    double speed = 0.0;  // ds/dt
    double curvature = 0.0;
  };

  std::array<double, 2> semi_axes_;
  std::vector<Point> points_;
};

// Line sources on a confocal ellipse inside, `count` of them in each quarter: there the
// boundary's fields must cancel the incoming wave. It is near the boundary, so that functions of
// all orders remain distinguishable also on a flat ellipse; the common foci keep it where fields
// continue inwards.
class InnerSources {
 public:
  // `wavenumber` over that of free space, real.
  InnerSources(const EllipseQuarter& boundary, double wavenumber, std::size_t count);

  // H_0^(2) of the distance, summed over the four mirror images with the signs of the symmetry.
  Family waves(const Symmetry& symmetry) const;

  // sqrt(e_n) J_n cos(n phi) or sin(n phi) at the sources (rows), times the four images.
  Eigen::MatrixXcd incoming(const Symmetry& symmetry) const;

 private:
  double wavenumber_;
  std::vector<double> x_, y_;
  std::array<Family, 4> images_;
};

}  // namespace rayloc
