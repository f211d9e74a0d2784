// SlabTable: the coefficients of one material's slab as polynomials of the angle of incidence.
//
// A path needs them at every interaction with the same permittivity, thickness and
// wavelength, so complex roots, exponentials and quotients are computed once, when a tracer
// is made. The error is below 1e-13 (1e-13 of the largest value for the excess terms).
// Where polynomials do not reach that, near grazing incidence, `find` returns nothing and
// slab.h has to be used.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/base/complex.h"
#include "engine/base/dual.h"

namespace rayloc {

class SlabTable {
 public:
  // Coefficients in the form of trace/interactions: r_te and r_excess, or t_te and t_excess.
  template <typename T>
  struct Pair {
    Complex<T> te;
    Complex<T> excess;
  };

  SlabTable() = default;  // covers no angle
  // thickness, wavelength: [m]; infinite thickness is a half space.
  SlabTable(const Complex<double>& relative_permittivity, double thickness, double wavelength);

  // False when the cosine of the angle of incidence is below the range of the table.
  bool covers(double cos_theta) const { return cos_theta >= least_cosine_; }

  // REQUIRES: covers(cos_theta).
  template <typename T>
  Pair<T> reflection(const T& cos_theta) const {
    return at<T>(cos_theta, 0);
  }
  template <typename T>
  Pair<T> transmission(const T& cos_theta) const {
    return at<T>(cos_theta, kPerPair);
  }

 private:
  // Chosen: eight coefficients, a cache line of doubles.
  static constexpr std::size_t kPolynomialDegree = 7;
  static constexpr std::size_t kPerPair = 4;  // real functions of a Pair
  // A count, of reflection and transmission.
  static constexpr std::size_t kFunctions = 2 * kPerPair;
  using Polynomial = std::array<double, kPolynomialDegree + 1>;
  using Interval = std::array<Polynomial, kFunctions>;

  template <typename T>
  Pair<T> at(const T& cos_theta, std::size_t first) const;

  double least_cosine_ = 2.0;  // above any cosine
  double per_interval_ = 0.0;  // intervals per unit of the cosine
  std::vector<Interval> intervals_;
};

template <typename T>
SlabTable::Pair<T> SlabTable::at(const T& cos_theta, std::size_t first) const {
  const double position = (value_of(cos_theta) - least_cosine_) * per_interval_;
  auto index = static_cast<std::size_t>(position);
  index = index < intervals_.size() ? index : intervals_.size() - 1;  // cos_theta = 1
  const double x = 2.0 * (position - static_cast<double>(index)) - 1.0;
  const double dx = 2.0 * per_interval_;
  std::array<T, kPerPair> result;
  for (std::size_t i = 0; i < kPerPair; ++i) {
    const Polynomial& c = intervals_[index][first + i];
    double value = c[kPolynomialDegree];
    double slope = 0.0;
    for (std::size_t k = kPolynomialDegree; k > 0; --k) {
      slope = slope * x + value;
      value = value * x + c[k - 1];
    }
    result[i] = composed(cos_theta, value, slope * dx);
  }
  return {{result[0], result[1]}, {result[2], result[3]}};
}

}  // namespace rayloc
