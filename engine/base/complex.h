// Complex<T>: a complex number whose parts may be dual numbers.
//
// std::complex<T> is unspecified for any T other than float, double and long
// double ([complex.numbers.general]), so it cannot carry derivatives.
#pragma once

#include <cmath>

namespace rayloc {

template <typename T>
struct Complex {
  T re{};
  T im{};

  friend Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
  friend Complex operator*(Complex a, Complex b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend Complex operator/(Complex a, Complex b) {
    const T d = b.re * b.re + b.im * b.im;
    return {(a.re * b.re + a.im * b.im) / d, (a.im * b.re - a.re * b.im) / d};
  }
};

template <typename T>
T abs2(Complex<T> z) {
  return z.re * z.re + z.im * z.im;
}

// Principal square root, Re > 0. Undefined for z on the negative real axis.
//
// The imaginary part is im / (2 Re sqrt(z)), not the textbook
// sqrt((|z| - re) / 2): the latter has an infinite derivative at im = 0, which
// turns the gradient of every lossless material into NaN.
template <typename T>
Complex<T> sqrt(Complex<T> z) {
  using std::sqrt;
  const T re = sqrt((sqrt(abs2(z)) + z.re) / T(2));
  return {re, z.im / (T(2) * re)};
}

// exp(z).
template <typename T>
Complex<T> exp(Complex<T> z) {
  using std::cos;
  using std::exp;
  using std::sin;
  const T m = exp(z.re);
  return {m * cos(z.im), m * sin(z.im)};
}

}  // namespace rayloc
