#include "engine/likelihood/gaussian/whitened_gaussian.h"

#include <cstddef>

namespace rayloc {

using Value = std::complex<double>;

std::vector<Value> whiten(const WhitenedGaussian& gaussian, std::span<const Value> y) {
  std::vector<Value> result(y.size());
  const std::complex<float>* w = gaussian.whitener.data();
  for (std::size_t i = 0; i < y.size(); ++i) {
    double re = 0.0;
    double im = 0.0;
    for (std::size_t j = 0; j <= i; ++j, ++w) {
      const auto a = static_cast<double>(w->real());
      const auto b = static_cast<double>(w->imag());
      re += a * y[j].real() - b * y[j].imag();
      im += a * y[j].imag() + b * y[j].real();
    }
    result[i] = {re, im};
  }
  return result;
}

std::vector<Value> unwhiten(const WhitenedGaussian& gaussian, std::span<const Value> u) {
  std::vector<Value> result(u.size());
  const std::complex<float>* w = gaussian.whitener.data();
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double re = u[i].real();
    const double im = u[i].imag();
    for (std::size_t j = 0; j <= i; ++j, ++w) {
      const auto a = static_cast<double>(w->real());
      const auto b = static_cast<double>(w->imag());
      result[j] += Value(a * re + b * im, a * im - b * re);
    }
  }
  return result;
}

// Avoids std::complex's product, which checks for infinities.
Value inner_product(std::span<const Value> a, std::span<const Value> b) {
  double re = 0.0;
  double im = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    re += a[i].real() * b[i].real() + a[i].imag() * b[i].imag();
    im += a[i].real() * b[i].imag() - a[i].imag() * b[i].real();
  }
  return {re, im};
}

double power_of(std::span<const Value> x) {
  double power = 0.0;
  for (const Value& v : x) {
    power += std::norm(v);
  }
  return power;
}

}  // namespace rayloc
