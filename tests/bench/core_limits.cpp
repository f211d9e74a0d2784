#include "tests/bench/core_limits.h"

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/core_limits.cpp"
#include <hwy/foreach_target.h>
// Follows foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayloc::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<float>;
using Vector = hn::Vec<Lanes>;

float total(Vector sum) { return hn::GetLane(hn::SumOfLanes(Lanes(), sum)); }

// `count` times twelve multiply-adds that do not wait for each other; how many flops that were.
double multiply_add(std::size_t count, float& keep) {
  const Vector x = hn::Set(Lanes(), 0.999F);
  const Vector y = hn::Set(Lanes(), 1e-3F);
  Vector a = y, b = y, c = y, d = y, e = y, f = y, g = y, h = y, i = y, j = y, k = y, l = y;
  for (std::size_t n = 0; n < count; ++n) {
    a = hn::MulAdd(a, x, y);
    b = hn::MulAdd(b, x, y);
    c = hn::MulAdd(c, x, y);
    d = hn::MulAdd(d, x, y);
    e = hn::MulAdd(e, x, y);
    f = hn::MulAdd(f, x, y);
    g = hn::MulAdd(g, x, y);
    h = hn::MulAdd(h, x, y);
    i = hn::MulAdd(i, x, y);
    j = hn::MulAdd(j, x, y);
    k = hn::MulAdd(k, x, y);
    l = hn::MulAdd(l, x, y);
  }
  keep += total(a) + total(b) + total(c) + total(d) + total(e) + total(f) + total(g) + total(h) +
          total(i) + total(j) + total(k) + total(l);
  return 24.0 * static_cast<double>(count * hn::Lanes(Lanes()));
}

float sum_of(const float* values, std::size_t size) {
  const std::size_t lanes = hn::Lanes(Lanes());
  Vector a = hn::Zero(Lanes()), b = a, c = a, d = a;
  for (std::size_t n = 0; n + 4 * lanes <= size; n += 4 * lanes) {
    a = hn::Add(a, hn::LoadU(Lanes(), values + n));
    b = hn::Add(b, hn::LoadU(Lanes(), values + n + lanes));
    c = hn::Add(c, hn::LoadU(Lanes(), values + n + 2 * lanes));
    d = hn::Add(d, hn::LoadU(Lanes(), values + n + 3 * lanes));
  }
  return total(hn::Add(hn::Add(a, b), hn::Add(c, d)));
}

}  // namespace rayloc::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc::bench {
namespace {

HWY_EXPORT(multiply_add);
HWY_EXPORT(sum_of);

double seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

CoreLimits core_limits() {
  constexpr int kTries = 8;
  constexpr std::size_t kCount = 2'000'000;
  CoreLimits limits;
  float keep = 0.0F;
  for (int i = 0; i < kTries; ++i) {
    const double begin = seconds();
    const double done = HWY_DYNAMIC_DISPATCH(multiply_add)(kCount, keep);
    limits.flops = std::max(limits.flops, done / (seconds() - begin));
  }
  const std::vector<float> values(std::size_t{64} << 20U, 0.5F);  // 256 MiB
  for (int i = 0; i < kTries; ++i) {
    const double begin = seconds();
    keep += HWY_DYNAMIC_DISPATCH(sum_of)(values.data(), values.size());
    limits.bytes = std::max(
        limits.bytes, static_cast<double>(values.size() * sizeof(float)) / (seconds() - begin));
  }
  volatile float kept = keep;
  static_cast<void>(kept);
  return limits;
}

}  // namespace rayloc::bench
#endif
