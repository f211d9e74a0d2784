#include "tests/bench/multiply_add_limit.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/multiply_add_limit.cpp"
#include <hwy/foreach_target.h>
// Follows foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayloc::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<double>;
using Vector = hn::Vec<Lanes>;

struct ComplexVector {
  Vector re;
  Vector im;
};

// Functions of their own: GCC gives the target's instructions neither to lambdas nor to implicit
// constructors.
ComplexVector zero() { return {hn::Zero(Lanes()), hn::Zero(Lanes())}; }
ComplexVector load(const ComplexFactors::Column& column, std::size_t i) {
  return {hn::Load(Lanes(), &column.re[i]), hn::Load(Lanes(), &column.im[i])};
}
HWY_INLINE void add_product(ComplexVector& sum, const ComplexVector& x, const ComplexVector& y) {
  sum.re = hn::MulAdd(x.re, y.re, sum.re);
  sum.im = hn::MulAdd(x.re, y.im, sum.im);
  sum.re = hn::NegMulAdd(x.im, y.im, sum.re);
  sum.im = hn::MulAdd(x.im, y.re, sum.im);
}
std::complex<double> total(const ComplexVector& sum) {
  return {hn::GetLane(hn::SumOfLanes(Lanes(), sum.re)),
          hn::GetLane(hn::SumOfLanes(Lanes(), sum.im))};
}

std::array<std::complex<double>, 4> products(const ComplexFactors& factors) {
  ComplexVector sum00 = zero();
  ComplexVector sum01 = zero();
  ComplexVector sum10 = zero();
  ComplexVector sum11 = zero();
  for (std::size_t pass = 0; pass < ComplexFactors::kPasses; ++pass) {
    for (std::size_t i = 0; i < ComplexFactors::kSize; i += hn::Lanes(Lanes())) {
      const ComplexVector x0 = load(factors.x[0], i);
      const ComplexVector x1 = load(factors.x[1], i);
      const ComplexVector y0 = load(factors.y[0], i);
      const ComplexVector y1 = load(factors.y[1], i);
      add_product(sum00, x0, y0);
      add_product(sum01, x0, y1);
      add_product(sum10, x1, y0);
      add_product(sum11, x1, y1);
    }
  }
  return {total(sum00), total(sum01), total(sum10), total(sum11)};
}

}  // namespace rayloc::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc::bench {

ComplexFactors::ComplexFactors() {
  for (std::size_t i = 0; i < kSize; ++i) {
    const auto angle = static_cast<double>(i);
    x[0].re[i] = std::cos(angle);
    x[0].im[i] = std::sin(angle);
    x[1].re[i] = std::cos(2.0 * angle);
    x[1].im[i] = std::sin(2.0 * angle);
  }
  y = x;
}

HWY_EXPORT(products);
std::array<std::complex<double>, 4> products(const ComplexFactors& factors) {
  return HWY_DYNAMIC_DISPATCH(products)(factors);
}

}  // namespace rayloc::bench
#endif
