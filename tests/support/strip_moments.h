// The field of a line source about a conducting strip, by the method of moments: the reference for
// waves over both of its edges. The electric field is along the edges (soft).
//
// The current is constant on each segment; segments are shorter near the edges, where the current
// is infinite (R. F. Harrington, Field Computation by Moment Methods (1968), section 3-2).
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Dense>

namespace rayloc::test {

class StripMoments {
 public:
  using Cd = std::complex<double>;
  using Point = std::pair<double, double>;

  // The strip is from (0, 0) to (width, 0); all lengths in wavelengths.
  StripMoments(double width, Point source) : source_(std::move(source)) {
    constexpr int kSegments = 160;
    for (int i = 0; i < kSegments; ++i) {
      const auto end = [&](int n) {
        return 0.5 * width * (1.0 - std::cos(std::numbers::pi * n / kSegments));
      };
      segments_.push_back({0.5 * (end(i) + end(i + 1)), end(i + 1) - end(i)});
    }
    Eigen::MatrixXcd coupled(kSegments, kSegments);
    Eigen::VectorXcd lit(kSegments);
    for (int i = 0; i < kSegments; ++i) {
      const double at = segments_[static_cast<std::size_t>(i)].middle;
      lit(i) = hankel(distance({at, 0.0}, source_));
      for (int j = 0; j < kSegments; ++j) {
        coupled(i, j) = coupling(at, segments_[static_cast<std::size_t>(j)], i == j);
      }
    }
    currents_ = coupled.partialPivLu().solve(lit);
  }

  // Field with the strip, normalised so that the wave alone is exp(-j k r) / sqrt(r) far away.
  Cd at(const Point& observer) const {
    Cd field = hankel(distance(observer, source_));
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      field -= currents_(static_cast<Eigen::Index>(i)) * segments_[i].width *
               hankel(distance({segments_[i].middle, 0.0}, observer));
    }
    return field /
           std::polar(std::sqrt(2.0 / (std::numbers::pi * kWaveNumber)), 0.25 * std::numbers::pi);
  }

 private:
  static constexpr double kWaveNumber = 2.0 * std::numbers::pi;

  struct Segment {
    double middle, width;
  };

  static double distance(const Point& a, const Point& b) {
    return std::hypot(a.first - b.first, a.second - b.second);
  }
  // The Hankel function of the second kind, of order 0.
  static Cd hankel(double distance) {
    const double x = kWaveNumber * distance;
    return {std::cyl_bessel_j(0, x), -std::cyl_neumann(0, x)};
  }
  // Field at a point of the strip due to a unit current on a segment.
  static Cd coupling(double at, const Segment& segment, bool is_own) {
    if (is_own) {
      const double euler = std::exp(std::numbers::egamma);
      const double small = euler * kWaveNumber * segment.width / 4.0;
      return segment.width * Cd{1.0, -2.0 / std::numbers::pi * (std::log(small) - 1.0)};
    }
    // Gauss-Legendre quadrature with six points.
    constexpr std::array<double, 3> kAt = {0.238619186083197, 0.661209386466265, 0.932469514203152};
    constexpr std::array<double, 3> kOf = {0.467913934572691, 0.360761573048139, 0.171324492379170};
    Cd sum;
    for (std::size_t i = 0; i < kAt.size(); ++i) {
      for (const double side : {-1.0, 1.0}) {
        const double from = segment.middle + side * kAt[i] * 0.5 * segment.width;
        sum += 0.5 * kOf[i] * hankel(std::abs(at - from));
      }
    }
    return segment.width * sum;
  }

  Point source_;
  std::vector<Segment> segments_;
  Eigen::VectorXcd currents_;
};

}  // namespace rayloc::test
