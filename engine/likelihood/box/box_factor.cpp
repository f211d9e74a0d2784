#include "engine/likelihood/box/box_factor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

// Highway compiles this file once for each kind of processor (see trace/cfr_kernel.cpp).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/likelihood/box/box_factor.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FactorLanes = hn::CappedTag<double, 8>;
using FactorVector = hn::Vec<FactorLanes>;
constexpr FactorLanes kFactorLanes;
constexpr std::size_t kFactorColumns = 4;  // a count: their sums fit into the registers

struct FactorComplex {
  FactorVector re;
  FactorVector im;
};

HWY_INLINE FactorComplex load_factor(const double* re, const double* im) {
  return {hn::LoadU(kFactorLanes, re), hn::LoadU(kFactorLanes, im)};
}
HWY_INLINE void store_factor(const FactorComplex& value, double* re, double* im) {
  hn::StoreU(value.re, kFactorLanes, re);
  hn::StoreU(value.im, kFactorLanes, im);
}
// sum - a b
HWY_INLINE FactorComplex less_factor_product(const FactorComplex& a,
                                             double re,
                                             double im,
                                             const FactorComplex& sum) {
  const FactorVector b_re = hn::Set(kFactorLanes, re);
  const FactorVector b_im = hn::Set(kFactorLanes, im);
  return {hn::MulAdd(a.im, b_im, hn::NegMulAdd(a.re, b_re, sum.re)),
          hn::NegMulAdd(a.im, b_re, hn::NegMulAdd(a.re, b_im, sum.im))};
}

// Adds rows `at` to `at` + lanes of four columns from the first on: the sum over the rays of
// x_row conj(x_column).
HWY_INLINE void add_factor_block(std::span<const double> re,
                                 std::span<const double> im,
                                 std::size_t stride,
                                 std::size_t at,
                                 std::size_t first,
                                 BoxFactor::Lines& columns) {
  std::array<FactorVector, kFactorColumns> sum_re;
  std::array<FactorVector, kFactorColumns> sum_im;
  for (std::size_t c = 0; c < kFactorColumns; ++c) {
    sum_re[c] = hn::LoadU(kFactorLanes, columns.re.data() + (first + c) * stride + at);
    sum_im[c] = hn::LoadU(kFactorLanes, columns.im.data() + (first + c) * stride + at);
  }
  for (std::size_t ray = 0; ray < re.size(); ray += stride) {
    const FactorComplex x = load_factor(re.data() + ray + at, im.data() + ray + at);
    for (std::size_t c = 0; c < kFactorColumns; ++c) {
      const FactorVector y_re = hn::Set(kFactorLanes, re[ray + first + c]);
      const FactorVector y_im = hn::Set(kFactorLanes, im[ray + first + c]);
      sum_re[c] = hn::MulAdd(x.im, y_im, hn::MulAdd(x.re, y_re, sum_re[c]));
      sum_im[c] = hn::NegMulAdd(x.re, y_im, hn::MulAdd(x.im, y_re, sum_im[c]));
    }
  }
  for (std::size_t c = 0; c < kFactorColumns; ++c) {
    hn::StoreU(sum_re[c], kFactorLanes, columns.re.data() + (first + c) * stride + at);
    hn::StoreU(sum_im[c], kFactorLanes, columns.im.data() + (first + c) * stride + at);
  }
}

void add_factor_rays(std::span<const double> re,
                     std::span<const double> im,
                     std::size_t stride,
                     BoxFactor::Lines& columns) {
  const std::size_t lanes = hn::Lanes(kFactorLanes);
  for (std::size_t at = 0; at < stride; at += lanes) {
    for (std::size_t first = 0; first < at + lanes; first += kFactorColumns) {
      add_factor_block(re, im, stride, at, first, columns);
    }
  }
}

// The triangle L of the covariance L L^H, column by column. False if it is not positive definite.
bool take_triangle(std::size_t size, std::size_t stride, BoxFactor::Lines& columns) {
  const std::size_t lanes = hn::Lanes(kFactorLanes);
  for (std::size_t j = 0; j < size; ++j) {
    double* re = columns.re.data() + j * stride;
    double* im = columns.im.data() + j * stride;
    const std::size_t begin = j / lanes * lanes;
    for (std::size_t at = begin; at < size; at += lanes) {
      FactorComplex sum = load_factor(re + at, im + at);
      for (std::size_t k = 0; k < j; ++k) {
        const double* of_re = columns.re.data() + k * stride;
        const double* of_im = columns.im.data() + k * stride;
        sum = less_factor_product(load_factor(of_re + at, of_im + at), of_re[j], -of_im[j], sum);
      }
      store_factor(sum, re + at, im + at);
    }
    if (!(re[j] > 0.0)) {
      return false;
    }
    const FactorVector scale = hn::Set(kFactorLanes, 1.0 / std::sqrt(re[j]));
    im[j] = 0.0;
    std::fill(re + begin, re + j, 0.0);
    std::fill(im + begin, im + j, 0.0);
    for (std::size_t at = begin; at < size; at += lanes) {
      const FactorComplex x = load_factor(re + at, im + at);
      store_factor({hn::Mul(x.re, scale), hn::Mul(x.im, scale)}, re + at, im + at);
    }
  }
  return true;
}

// The inverse of L, row by row.
void invert_triangle(std::size_t size,
                     std::size_t stride,
                     const BoxFactor::Lines& columns,
                     BoxFactor::Lines& rows) {
  const std::size_t lanes = hn::Lanes(kFactorLanes);
  for (std::size_t i = 0; i < size; ++i) {
    double* re = rows.re.data() + i * stride;
    double* im = rows.im.data() + i * stride;
    re[i] = 1.0;
    const FactorVector scale = hn::Set(kFactorLanes, 1.0 / columns.re[i * stride + i]);
    for (std::size_t at = 0; at <= i; at += lanes) {
      FactorComplex sum = load_factor(re + at, im + at);
      for (std::size_t k = at; k < i; ++k) {
        const FactorComplex x =
            load_factor(rows.re.data() + k * stride + at, rows.im.data() + k * stride + at);
        sum = less_factor_product(x, columns.re[k * stride + i], columns.im[k * stride + i], sum);
      }
      store_factor({hn::Mul(sum.re, scale), hn::Mul(sum.im, scale)}, re + at, im + at);
    }
  }
}

// Eight numbers.
void take_unit_phasors(const double* turns, double* re, double* im) {
  for (std::size_t n = 0; n < 8; n += hn::Lanes(kFactorLanes)) {
    const FactorVector x = hn::LoadU(kFactorLanes, turns + n);
    const FactorVector phase =
        hn::Mul(hn::Sub(hn::Round(x), x), hn::Set(kFactorLanes, 6.283185307179586));
    store_factor({hn::Cos(kFactorLanes, phase), hn::Sin(kFactorLanes, phase)}, re + n, im + n);
  }
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc {
HWY_EXPORT(add_factor_rays);
HWY_EXPORT(take_triangle);
HWY_EXPORT(invert_triangle);
HWY_EXPORT(take_unit_phasors);

BoxFactor::BoxFactor(std::size_t dimension) : dimension_(dimension) {
  RAYLOC_CHECK(dimension > 0);
  const std::size_t size = padded(dimension) * padded(dimension);
  for (std::vector<double>* one : {&columns_.re, &columns_.im, &rows_.re, &rows_.im}) {
    one->resize(size);
  }
}

void BoxFactor::add(std::span<const double> re, std::span<const double> im) {
  const std::size_t stride = padded(dimension_);
  RAYLOC_CHECK(re.size() == im.size() && re.size() % stride == 0);
  HWY_DYNAMIC_DISPATCH(add_factor_rays)(re, im, stride, columns_);
}

void BoxFactor::add(std::size_t row, std::size_t column, std::complex<double> value) {
  const std::size_t at = column * padded(dimension_) + row;
  columns_.re[at] += value.real();
  columns_.im[at] += value.imag();
}

void BoxFactor::factorise() {
  const std::size_t stride = padded(dimension_);
  RAYLOC_CHECK(HWY_DYNAMIC_DISPATCH(take_triangle)(dimension_, stride, columns_));
  HWY_DYNAMIC_DISPATCH(invert_triangle)(dimension_, stride, columns_, rows_);
}

std::complex<double> BoxFactor::whitener(std::size_t row, std::size_t column) const {
  const std::size_t at = row * padded(dimension_) + column;
  return {rows_.re[at], rows_.im[at]};
}

double BoxFactor::log_determinant() const {
  double result = 0.0;
  for (std::size_t i = 0; i < dimension_; ++i) {
    result -= 2.0 * std::log(whitener(i, i).real());
  }
  return result;
}

std::vector<std::complex<double>> BoxFactor::whiten(std::span<const std::complex<double>> x) const {
  RAYLOC_CHECK(x.size() == dimension_);
  std::vector<std::complex<double>> result;
  for (std::size_t i = 0; i < dimension_; ++i) {
    double re = 0.0;
    double im = 0.0;
    for (std::size_t j = 0; j <= i; ++j) {
      const std::complex<double> w = whitener(i, j);
      re += w.real() * x[j].real() - w.imag() * x[j].imag();
      im += w.real() * x[j].imag() + w.imag() * x[j].real();
    }
    result.emplace_back(re, im);
  }
  return result;
}

void unit_phasors(std::span<const double> turns, std::span<double> re, std::span<double> im) {
  RAYLOC_CHECK(turns.size() == re.size() && turns.size() == im.size());
  std::size_t n = 0;
  for (; n + 8 <= turns.size(); n += 8) {
    HWY_DYNAMIC_DISPATCH(take_unit_phasors)(turns.data() + n, re.data() + n, im.data() + n);
  }
  if (n < turns.size()) {
    std::array<double, 8> x{};
    std::array<double, 8> out_re{};
    std::array<double, 8> out_im{};
    const std::size_t left = turns.size() - n;
    std::copy_n(turns.data() + n, left, x.begin());
    HWY_DYNAMIC_DISPATCH(take_unit_phasors)(x.data(), out_re.data(), out_im.data());
    std::copy_n(out_re.begin(), left, re.data() + n);
    std::copy_n(out_im.begin(), left, im.data() + n);
  }
}

}  // namespace rayloc
#endif  // HWY_ONCE
