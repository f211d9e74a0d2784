// The profiled gain for all lanes of a vector register, shared by lane_kernel.cpp and
// chain_kernel.cpp. Highway compiles it once for each kind of processor, so it is not an ordinary
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
