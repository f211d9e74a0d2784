// ScatteringLobe: distribution of the scattered power of a rough surface over directions.
//
// With u_i, u_s the cosines of incidence and of scattering, psi_r the angle from the mirrored
// direction and psi_i that from the direction back to the source, a surface element of area dA that
// is illuminated with the power density p scatters
//   S^2 p dA w,   w = u_i u_s K / (B(u_i) B(u_s)) G(u_i) G(u_s)   per unit of solid angle,
// where G is the power reflectance of the smooth surface, the mean of both polarisations, and K the
// lobe of [DE]: 1, ((1 + cos psi_r) / 2)^alpha_r, or lambda of it and 1 - lambda of the same about
// the direction back. B is the balance: over the half space of u_s, w is u_i G(u_i) for every u_i,
// so that scattered and reflected power together are the reflection of a smooth surface. Since w
// does not change when both ends are exchanged, that is one equation for a function of one cosine,
//   B(u) = integral of K u' G(u') / B(u')  over the half space of u',
// solved once for a surface. [DE] divides by the integral of K instead, the F_alpha of its (8) and
// (19), and has no u_s: the balance is kept, but not the symmetry. Lambertian lobes of a perfect
// reflector are the same in both, u_i u_s / pi.
//
// Written in a scalar T, so that with dual numbers it carries derivatives by the lobe's widths and
// by all quantities that G depends on.
//
// References:
//   [DE] surface_scattering.h.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "engine/em/surface_scattering.h"

namespace rayloc {

// A count, measured: at alpha 100 the balance is kept to 1e-3 (scattering_lobe_test.cpp).
inline constexpr std::size_t kLobeNodes = 32;

struct LobeNodes {
  std::array<double, kLobeNodes> cosine{};  // of Gauss and Legendre's rule over [0, 1]
  std::array<double, kLobeNodes> weight{};
  // [k][i]: weight of node i in the k-th coefficient of Legendre's polynomials.
  std::array<std::array<double, kLobeNodes>, kLobeNodes> legendre{};
};
const LobeNodes& lobe_nodes();

template <typename T>
struct LobeShape {
  ScatteringPattern pattern = ScatteringPattern::kLambertian;
  T alpha_r{};
  T alpha_i{};
  T lambda{};
};

// K, as a function of the cosines of psi_r and psi_i.
template <typename T>
T lobe_kernel(const LobeShape<T>& shape, const T& cos_reflected, const T& cos_back) {
  using std::exp;
  using std::log;
  const auto lobe = [](const T& cosine, const T& alpha) {
    // Below this nothing is scattered: it bounds the logarithm; a number, chosen.
    constexpr double kDark = 1e-30;
    const T base = T(0.5) * (T(1) + cosine);
    return base > T(kDark) ? T(exp(alpha * log(base))) : T(0);
  };
  switch (shape.pattern) {
    case ScatteringPattern::kDirective:
      return lobe(cos_reflected, shape.alpha_r);
    case ScatteringPattern::kBackscattering:
      return shape.lambda * lobe(cos_reflected, shape.alpha_r) +
             (T(1) - shape.lambda) * lobe(cos_back, shape.alpha_i);
    case ScatteringPattern::kLambertian:
      break;
  }
  return T(1);
}

template <typename T>
class ScatteringLobe {
 public:
  using AtNodes = std::array<T, kLobeNodes>;

  // `reflectance`: G at the cosines of lobe_nodes(), > 0.
  ScatteringLobe(const LobeShape<T>& shape, const AtNodes& reflectance);
  // A constant lobe, without derivatives.
  template <typename U>
  explicit ScatteringLobe(const ScatteringLobe<U>& lobe)
      : shape_{lobe.shape().pattern,
               T(lobe.shape().alpha_r),
               T(lobe.shape().alpha_i),
               T(lobe.shape().lambda)} {
    for (std::size_t k = 0; k < kLobeNodes; ++k) {
      coefficient_[k] = T(lobe.coefficients()[k]);
    }
  }

  // One end of a path over the surface.
  struct End {
    T cosine{};       // of the angle from the normal
    T reflectance{};  // G at that cosine
  };
  // w, without S^2. REQUIRES: both cosines > 0.
  T weight(const End& in, const End& out, const T& cos_reflected, const T& cos_back) const {
    return in.cosine * out.cosine * lobe_kernel(shape_, cos_reflected, cos_back) * in.reflectance *
           out.reflectance / (balance(in.cosine) * balance(out.cosine));
  }

  const LobeShape<T>& shape() const { return shape_; }
  const AtNodes& coefficients() const { return coefficient_; }

 private:
  T balance(const T& cosine) const;  // B
  using Matrix = std::array<AtNodes, kLobeNodes>;
  Matrix around_normal() const;  // K between two nodes, over all azimuths

  LobeShape<T> shape_;
  AtNodes coefficient_{};  // of B, in Legendre's polynomials of 2 u - 1
};

template <typename T>
ScatteringLobe<T>::ScatteringLobe(const LobeShape<T>& shape, const AtNodes& reflectance)
    : shape_(shape) {
  using std::sqrt;
  // Each step halves the error, since no eigenvalue of K is much below zero.
  constexpr int kSteps = 60;
  const LobeNodes& nodes = lobe_nodes();
  const Matrix kernel = around_normal();
  AtNodes balance;
  balance.fill(T(1));
  for (int step = 0; step < kSteps; ++step) {
    AtNodes next;
    for (std::size_t i = 0; i < kLobeNodes; ++i) {
      T sum(0);
      for (std::size_t j = 0; j < kLobeNodes; ++j) {
        sum =
            sum + T(nodes.weight[j] * nodes.cosine[j]) * kernel[i][j] * reflectance[j] / balance[j];
      }
      next[i] = sqrt(balance[i] * sum);
    }
    balance = next;
  }
  for (std::size_t k = 0; k < kLobeNodes; ++k) {
    for (std::size_t i = 0; i < kLobeNodes; ++i) {
      coefficient_[k] = coefficient_[k] + T(nodes.legendre[k][i]) * balance[i];
    }
  }
}

template <typename T>
typename ScatteringLobe<T>::Matrix ScatteringLobe<T>::around_normal() const {
  // Over half a turn; a count: a lobe of alpha 100 is wider than three of them.
  constexpr std::size_t kAzimuths = 32;
  const LobeNodes& nodes = lobe_nodes();
  Matrix kernel;
  for (std::size_t i = 0; i < kLobeNodes; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double along = nodes.cosine[i] * nodes.cosine[j];
      const double across = std::sqrt((1.0 - nodes.cosine[i] * nodes.cosine[i]) *
                                      (1.0 - nodes.cosine[j] * nodes.cosine[j]));
      T sum(0);
      for (std::size_t m = 0; m < kAzimuths; ++m) {
        const double turn = std::cos(std::numbers::pi * (static_cast<double>(m) + 0.5) / kAzimuths);
        sum = sum + lobe_kernel(shape_, T(along + across * turn), T(along - across * turn));
      }
      kernel[i][j] = T(2.0 * std::numbers::pi / kAzimuths) * sum;
      kernel[j][i] = kernel[i][j];
    }
  }
  return kernel;
}

template <typename T>
T ScatteringLobe<T>::balance(const T& cosine) const {
  const T x = T(2) * cosine - T(1);
  T before(1);
  T here = x;
  T sum = coefficient_[0] + coefficient_[1] * x;
  for (std::size_t k = 2; k < kLobeNodes; ++k) {
    const auto order = static_cast<double>(k);
    const T next = T((2.0 * order - 1.0) / order) * x * here - T((order - 1.0) / order) * before;
    before = here;
    here = next;
    sum = sum + coefficient_[k] * here;
  }
  return sum;
}

}  // namespace rayloc
