// The exact field about a perfectly conducting wedge, by its eigenfunctions, and its geometrical-
// optics part. Uses std::cyl_bessel_j of fractional order, which the program does not use.
//
// References:
//   [B] J. J. Bowman et al., Electromagnetic and acoustic scattering by simple shapes (1969), 6.2.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace rayloc::test {

enum class Wall { kSoft, kHard };

// Wedge of exterior angle n pi, observed at k rho = `kr` from the edge. Lengths are in 1 / k.
class ExactWedge {
 public:
  // A plane wave of amplitude 1 at the edge.
  ExactWedge(double n, double kr) : n_(n), kr_(kr) {
    for (double order = 0.0; order < last_order(); order += 1.0 / n) {
      const double quarter = std::numbers::pi / 2.0 * std::fmod(order, 4.0);
      radial_.push_back(std::polar(std::cyl_bessel_j(order, kr), quarter));
    }
  }

  // A line source H_0^(2), further from the edge than the observer.
  ExactWedge(double n, double kr, double kr_source) : n_(n), kr_(kr), kr_source_(kr_source) {
    for (double order = 0.0; order < last_order(); order += 1.0 / n) {
      radial_.push_back(std::cyl_bessel_j(order, kr) * hankel(order, kr_source));
    }
  }

  // [B] (6.30), (6.31); with `slope` their derivatives with respect to `from`.
  std::complex<double> field(double from, double to, Wall wall, bool slope = false) const {
    std::complex<double> sum;
    for (std::size_t m = 0; m < radial_.size(); ++m) {
      const double order = static_cast<double>(m) / n_;
      const double there = wall == Wall::kHard ? std::cos(order * to) : std::sin(order * to);
      const double here = wall == Wall::kHard ? std::cos(order * from) : std::sin(order * from);
      const double rotated = wall == Wall::kHard ? -std::sin(order * from) : std::cos(order * from);
      sum += (m == 0 ? 1.0 : 2.0) * (there * (slope ? order * rotated : here)) * radial_[m];
    }
    return 2.0 / n_ * sum;
  }

  // The incident wave and its images in the faces, each in its lit region.
  std::complex<double> geometrical(double from, double to, Wall wall, bool slope = false) const {
    constexpr int kTurns = 7;  // enough for the images of faces at 30 degrees
    const double sign = wall == Wall::kHard ? 1.0 : -1.0;
    std::complex<double> sum;
    for (int turn = -kTurns; turn <= kTurns; ++turn) {
      const double off = 2.0 * std::numbers::pi * n_ * turn;
      sum += wave(to - from + off, slope ? -1.0 : 0.0) +
             sign * wave(to + from + off, slope ? 1.0 : 0.0);
    }
    return sum;
  }

  // Reference field of a diffracted wave.
  std::complex<double> along_the_edge() const {
    return kr_source_ == 0.0 ? std::polar(1.0, -kr_) : hankel(0.0, kr_ + kr_source_);
  }
  double phase_length() const {
    return kr_source_ == 0.0 ? kr_ : kr_ * kr_source_ / (kr_ + kr_source_);
  }

 private:
  // J of higher orders is below 1e-15.
  double last_order() const { return kr_ + 12.0 + 7.0 * std::cbrt(kr_); }

  static std::complex<double> hankel(double order, double x) {
    return {std::cyl_bessel_j(order, x), -std::cyl_neumann(order, x)};
  }

  // The wave of a source at this azimuth; with `rotated` != 0 the slope of a plane wave.
  std::complex<double> wave(double angle, double rotated) const {
    if (std::abs(angle) > std::numbers::pi) {
      return 0.0;
    }
    if (kr_source_ == 0.0) {
      const std::complex<double> value = std::polar(1.0, kr_ * std::cos(angle));
      return rotated == 0.0 ? value
                            : std::complex<double>(0.0, -kr_ * std::sin(angle) * rotated) * value;
    }
    return hankel(
        0.0,
        std::sqrt(kr_ * kr_ + kr_source_ * kr_source_ - 2.0 * kr_ * kr_source_ * std::cos(angle)));
  }

  double n_;
  double kr_;
  double kr_source_ = 0.0;  // 0: a plane wave
  std::vector<std::complex<double>> radial_;
};

}  // namespace rayloc::test
