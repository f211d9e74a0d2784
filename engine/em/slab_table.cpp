#include "engine/em/slab_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "engine/em/slab.h"

namespace rayloc {
namespace {

// A cosine of incidence, chosen: 87 degrees; beyond, the slab is computed exactly.
constexpr double kMinCosine = 0.05;
constexpr double kTolerance = 1e-13;  // a ratio, chosen: slightly above the rounding of a double
// A count, chosen: the first trial for a thin slab.
constexpr std::size_t kFewestIntervals = 16;
// A count, chosen: a slab that needs more has no table.
constexpr std::size_t kMaxIntervals = 1024;

// Interpolation at Chebyshev nodes of [-1, 1] by divided differences, then expanded in powers.
template <std::size_t N, typename F>
auto interpolate(const F& f) {
  using Values = decltype(f(0.0));
  std::array<double, N> node{};
  std::array<Values, N> d{};
  for (std::size_t k = 0; k < N; ++k) {
    node.at(k) = std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / N);
    d.at(k) = f(node.at(k));
  }
  std::array<std::array<double, N>, std::tuple_size_v<Values>> polynomials{};
  for (std::size_t i = 0; i < polynomials.size(); ++i) {
    for (std::size_t level = 1; level < N; ++level) {
      for (std::size_t k = N - 1; k >= level; --k) {
        d.at(k).at(i) = (d.at(k).at(i) - d.at(k - 1).at(i)) / (node.at(k) - node.at(k - level));
      }
    }
    auto& p = polynomials.at(i);
    for (std::size_t k = N; k > 0; --k) {  // p (x - node) + d
      for (std::size_t j = N - 1; j > 0; --j) {
        p.at(j) = p.at(j - 1) - node.at(k - 1) * p.at(j);
      }
      p.at(0) = d.at(k - 1).at(i) - node.at(k - 1) * p.at(0);
    }
  }
  return polynomials;
}

template <typename Polynomial>
double evaluate(const Polynomial& p, double x) {
  return std::accumulate(
      p.rbegin(), p.rend(), 0.0, [x](double sum, double c) { return sum * x + c; });
}

}  // namespace

SlabTable::SlabTable(const Complex<double>& relative_permittivity,
                     double thickness,
                     double wavelength) {
  const auto exact = [&](double cos_theta) {
    const auto s = std::isinf(thickness)
                       ? half_space_coefficients(cos_theta, relative_permittivity)
                       : slab_coefficients(cos_theta, relative_permittivity, thickness, wavelength);
    return std::array<double, kFunctions>{s.r_te.re,
                                          s.r_te.im,
                                          s.r_excess.re,
                                          s.r_excess.im,
                                          s.t_te.re,
                                          s.t_te.im,
                                          s.t_excess.re,
                                          s.t_excess.im};
  };
  for (std::size_t count = kFewestIntervals; count <= kMaxIntervals; count *= 2) {
    const double width = (1.0 - kMinCosine) / static_cast<double>(count);
    intervals_.clear();
    double worst = 0.0;
    double largest = 1.0;
    // The first intervals, near grazing incidence, are the hardest.
    for (std::size_t i = 0; i < count && worst <= kTolerance * largest; ++i) {
      const double middle = kMinCosine + (static_cast<double>(i) + 0.5) * width;
      const auto f = [&](double x) { return exact(middle + 0.5 * x * width); };
      intervals_.push_back(interpolate<kPolynomialDegree + 1>(f));
      for (const double x : {-1.0, -0.55, -0.1, 0.3, 0.75, 1.0}) {  // between the nodes
        const auto value = f(x);
        for (std::size_t k = 0; k < kFunctions; ++k) {
          const double fitted = evaluate(intervals_.back().at(k), x);
          worst = std::max(worst, std::abs(fitted - value.at(k)));
          largest = std::max(largest, std::abs(value.at(k)));
        }
      }
    }
    if (worst <= kTolerance * largest) {
      least_cosine_ = kMinCosine;
      per_interval_ = 1.0 / width;
      return;
    }
  }
  intervals_.clear();
}

}  // namespace rayloc
