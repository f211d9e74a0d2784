// The profiled gain and complex sums for all lanes of a vector register, shared by the kernels of
// this folder. Highway compiles it once for each kind of processor, so it is not an ordinary
// header: include it after hwy/foreach_target.h.
#if defined(RAYLOC_ENGINE_LIKELIHOOD_LANE_GAIN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYLOC_ENGINE_LIKELIHOOD_LANE_GAIN_INL_H_
#undef RAYLOC_ENGINE_LIKELIHOOD_LANE_GAIN_INL_H_
#else
#define RAYLOC_ENGINE_LIKELIHOOD_LANE_GAIN_INL_H_
#endif

#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "engine/likelihood/lane_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, kLaneCount>;
using Vector = hn::Vec<Lanes>;
constexpr Lanes kLanes;  // lanes of a vector register of the machine, up to kLaneCount

struct Complex {
  Vector re;
  Vector im;
};

HWY_INLINE Complex load(const LaneSums& sums, std::size_t t) {
  return {hn::LoadU(kLanes, sums.re.data() + t), hn::LoadU(kLanes, sums.im.data() + t)};
}

HWY_INLINE Complex no_sum() { return {hn::Zero(kLanes), hn::Zero(kLanes)}; }

// Four independent sums, to avoid a dependency chain: of a re, b im, a im, b re.
struct Products {
  Vector a_re;
  Vector b_im;
  Vector a_im;
  Vector b_re;
};

HWY_INLINE Products no_products() {
  const Vector zero = hn::Zero(kLanes);
  return {zero, zero, zero, zero};
}
// Adds the products of w x.
HWY_INLINE void add(float w_re, float w_im, const Complex& x, Products& sums) {
  const Vector a = hn::Set(kLanes, w_re);
  const Vector b = hn::Set(kLanes, w_im);
  sums.a_re = hn::MulAdd(a, x.re, sums.a_re);
  sums.b_im = hn::MulAdd(b, x.im, sums.b_im);
  sums.a_im = hn::MulAdd(a, x.im, sums.a_im);
  sums.b_re = hn::MulAdd(b, x.re, sums.b_re);
}
HWY_INLINE Complex sum_of(const Products& sums) {
  return {hn::Sub(sums.a_re, sums.b_im), hn::Add(sums.a_im, sums.b_re)};
}

// 2 D ln r - r^2 a + 2 r |b| at r = (b + sqrt(b^2 + 4 a D)) / 2 a, with b = |along|.
HWY_INLINE Vector best_profile(Vector a, const Complex& along, Vector dimension) {
  const Vector b2 = hn::MulAdd(along.im, along.im, hn::Mul(along.re, along.re));
  const Vector b = hn::Sqrt(b2);
  const Vector root = hn::Sqrt(hn::MulAdd(hn::Mul(hn::Set(kLanes, 4.0F), dimension), a, b2));
  const Vector ar = hn::Mul(hn::Set(kLanes, 0.5F), hn::Add(b, root));
  const Vector r = hn::Div(ar, a);
  const Vector two = hn::Set(kLanes, 2.0F);
  const Vector linear = hn::Mul(r, hn::Sub(hn::Mul(two, b), ar));
  return hn::MulAdd(hn::Mul(two, dimension), hn::Log(kLanes, r), linear);
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // for each kind of processor
