#include "engine/likelihood/box/place_kernel.h"

#include <algorithm>

#include "engine/base/check.h"
#include "engine/base/work_done.h"
#include "engine/likelihood/min_power.h"

// Highway compiles this file once for each kind of processor (see trace/cfr_kernel.cpp).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/likelihood/box/place_kernel.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "engine/likelihood/lane_gain_inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// As LaneSums, in one cache line and not initialized: a box has 16 kB of them.
struct alignas(64) BoxLanes {
  std::array<float, kLaneCount> re;
  std::array<float, kLaneCount> im;
};
using BoxVectors = std::array<BoxLanes, kMaxBoxDimension>;  // [coordinate]
using BoxPhasors = std::array<std::array<BoxLanes, kMaxBoxRays>, kMaxBoxAntennas>;

HWY_INLINE Complex of_box_lanes(const BoxLanes& lanes) {
  return {hn::LoadU(kLanes, lanes.re.data()), hn::LoadU(kLanes, lanes.im.data())};
}
HWY_INLINE void put_box_lanes(const Complex& value, BoxLanes& to) {
  hn::StoreU(value.re, kLanes, to.re.data());
  hn::StoreU(value.im, kLanes, to.im.data());
}
// sum + a b
HWY_INLINE Complex add_box_times(const Complex& a, const float* b, const Complex& sum) {
  const Vector re = hn::Set(kLanes, b[0]);
  const Vector im = hn::Set(kLanes, b[1]);
  return {hn::NegMulAdd(a.im, im, hn::MulAdd(a.re, re, sum.re)),
          hn::MulAdd(a.im, re, hn::MulAdd(a.re, im, sum.im))};
}
// sum + conj(a) b
HWY_INLINE Complex add_box_conjugate(const Complex& a, const float* b, const Complex& sum) {
  const Vector re = hn::Set(kLanes, b[0]);
  const Vector im = hn::Set(kLanes, b[1]);
  return {hn::MulAdd(a.im, im, hn::MulAdd(a.re, re, sum.re)),
          hn::NegMulAdd(a.im, re, hn::MulAdd(a.re, im, sum.im))};
}
HWY_INLINE Vector add_box_power(const Complex& a, Vector sum) {
  return hn::MulAdd(a.re, a.re, hn::MulAdd(a.im, a.im, sum));
}

// Displacements from the middle of a box.
struct BoxOffsets {
  Vector x;
  Vector y;
  Vector z;
  Vector square;
};

// `next` + x u with u the square of a phase: one step of a polynomial.
HWY_INLINE Vector box_step(Vector x, Vector u, float next) {
  return hn::MulAdd(x, u, hn::Set(kLanes, next));
}

// exp(-2 pi j x), x in turns, |x| < 2^20. Half turns are removed by rounding to a multiple of one
// half, whose lowest bit becomes the sign.
HWY_INLINE Complex box_phasor(Vector x) {
  const Vector magic = hn::Set(kLanes, 12582912.0F);  // 1.5 * 2^23
  const Vector shifted = hn::Add(hn::Add(x, x), magic);
  const Vector halves = hn::Sub(shifted, magic);
  const hn::RebindToUnsigned<Lanes> bits;
  const Vector sign = hn::BitCast(kLanes, hn::ShiftLeft<31>(hn::BitCast(bits, shifted)));
  const Vector rest = hn::NegMulAdd(hn::Set(kLanes, 0.5F), halves, x);
  const Vector phase = hn::Mul(rest, hn::Set(kLanes, 6.283185307179586F));
  const Vector u = hn::Mul(phase, phase);
  Vector sine = hn::Set(kLanes, 2.7525562e-6F);
  sine = box_step(sine, u, -1.9840874e-4F);
  sine = box_step(sine, u, 8.3333310e-3F);
  sine = box_step(sine, u, -0.16666667F);
  sine = hn::MulAdd(hn::Mul(sine, u), phase, phase);
  Vector cosine = hn::Set(kLanes, 2.4760495e-5F);
  cosine = box_step(cosine, u, -1.3888378e-3F);
  cosine = box_step(cosine, u, 4.1666638e-2F);
  cosine = box_step(cosine, u, -0.5F);
  cosine = box_step(cosine, u, 1.0F);
  return {hn::Xor(cosine, sign), hn::Xor(hn::Neg(sine), sign)};
}

// exp(j x), |x| [rad] at most kMaxSlopePhase or little more.
HWY_INLINE Complex small_box_phasor(Vector x) {
  const Vector u = hn::Mul(x, x);
  Vector sine = hn::Set(kLanes, -1.9840874e-4F);
  sine = box_step(sine, u, 8.3333310e-3F);
  sine = box_step(sine, u, -0.16666667F);
  sine = hn::MulAdd(hn::Mul(sine, u), x, x);
  Vector cosine = hn::Set(kLanes, -1.3888378e-3F);
  cosine = box_step(cosine, u, 4.1666638e-2F);
  cosine = box_step(cosine, u, -0.5F);
  cosine = box_step(cosine, u, 1.0F);
  return {cosine, sine};
}

// a x
HWY_INLINE Vector along_box(const float* a, const BoxOffsets& d) {
  return hn::MulAdd(hn::Set(kLanes, a[0]),
                    d.x,
                    hn::MulAdd(hn::Set(kLanes, a[1]), d.y, hn::Mul(hn::Set(kLanes, a[2]), d.z)));
}

// The phasor of an image { x y z, square, phase } at these places.
HWY_INLINE Complex phasor_of_image(const float* image, const BoxOffsets& d, Vector per_metre) {
  const Vector square = hn::Add(d.square, hn::Set(kLanes, image[3]));
  const Vector dot = along_box(image, d);
  const Vector length = hn::Sqrt(hn::Sub(square, hn::Add(dot, dot)));
  return box_phasor(hn::MulAdd(length, per_metre, hn::Set(kLanes, image[4])));
}

// Phasors of all rays at all antennas.
HWY_INLINE void take_box_phasors(const PlaceBox& box, const BoxOffsets& d, BoxPhasors& out) {
  const Vector per_metre = hn::Set(kLanes, box.turns_per_metre);
  const std::size_t antennas = box.size().antennas;
  for (std::size_t p = 0; p < box.size().rays; ++p) {
    const float* of = box.ray(p);
    const Complex first = phasor_of_image(of, d, per_metre);
    put_box_lanes(first, out[0][p]);
    for (std::size_t m = 1; m < antennas; ++m) {
      of += PlaceBox::kAntennaFloats;
      if (box.has_wide_slopes) {
        put_box_lanes(phasor_of_image(of, d, per_metre), out[m][p]);
        continue;
      }
      const Complex slope = small_box_phasor(along_box(of + 2, d));
      const Complex both{hn::NegMulAdd(first.im, slope.im, hn::Mul(first.re, slope.re)),
                         hn::MulAdd(first.im, slope.re, hn::Mul(first.re, slope.im))};
      put_box_lanes(add_box_times(both, of, no_sum()), out[m][p]);
    }
  }
}

// The mean at `kCount` coordinates of one antenna from the first on, with the sums in registers.
template <std::size_t kCount>
HWY_INLINE void take_box_mean(const PlaceBox& box,
                              const std::array<BoxLanes, kMaxBoxRays>& phasors,
                              std::size_t first,
                              BoxLanes* out) {
  std::array<Vector, kCount> sum_re;
  std::array<Vector, kCount> sum_im;
  for (std::size_t i = 0; i < kCount; ++i) {
    sum_re[i] = hn::Zero(kLanes);
    sum_im[i] = hn::Zero(kLanes);
  }
  const std::size_t rays = box.size().rays;
  const std::size_t stride = 2 * box.size().coordinates;
  const float* mean = box.mean(0) + 2 * first;
  for (std::size_t p = 0; p < rays; ++p, mean += stride) {
    const Complex phasor = of_box_lanes(phasors[p]);
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vector a = hn::Set(kLanes, mean[2 * i]);
      const Vector b = hn::Set(kLanes, mean[2 * i + 1]);
      sum_re[i] = hn::NegMulAdd(phasor.im, b, hn::MulAdd(phasor.re, a, sum_re[i]));
      sum_im[i] = hn::MulAdd(phasor.im, a, hn::MulAdd(phasor.re, b, sum_im[i]));
    }
  }
  for (std::size_t i = 0; i < kCount; ++i) {
    put_box_lanes({sum_re[i], sum_im[i]}, out[first + i]);
  }
}

HWY_INLINE void take_box_means(const PlaceBox& box, const BoxPhasors& phasors, BoxVectors& out) {
  const std::size_t q = box.size().coordinates;
  for (std::size_t m = 0; m < box.size().antennas; ++m) {
    std::size_t i = 0;
    for (; i + 6 <= q; i += 6) {
      take_box_mean<6>(box, phasors[m], i, out.data() + m * q);
    }
    for (; i + 4 <= q; i += 4) {
      take_box_mean<4>(box, phasors[m], i, out.data() + m * q);
    }
    for (; i < q; ++i) {
      take_box_mean<1>(box, phasors[m], i, out.data() + m * q);
    }
  }
}

// Removes the line of sight, ray 0.
HWY_INLINE void obstruct_box(const PlaceBox& box, const BoxPhasors& phasors, BoxVectors& mean) {
  const std::size_t q = box.size().coordinates;
  for (std::size_t m = 0; m < box.size().antennas; ++m) {
    const Complex phasor = of_box_lanes(phasors[m][0]);
    for (std::size_t i = 0; i < q; ++i) {
      const Complex all = of_box_lanes(mean[m * q + i]);
      const Complex direct = add_box_times(phasor, box.mean(0) + 2 * i, no_sum());
      put_box_lanes({hn::Sub(all.re, direct.re), hn::Sub(all.im, direct.im)}, mean[m * q + i]);
    }
  }
}

// |W mu|^2 and (W mu)^H W y of each delay.
struct BoxSums {
  Vector power;
  std::array<Complex, kBoxDelays> along;
};
// Adds coordinate i of W mu. `observed`: that coordinate of the first delay.
HWY_INLINE void collect_box(const Complex& x,
                            const float* observed,
                            std::size_t stride,
                            BoxSums& sums) {
  sums.power = add_box_power(x, sums.power);
  for (std::size_t k = 0; k < kBoxDelays; ++k) {
    sums.along[k] = add_box_conjugate(x, observed + k * stride, sums.along[k]);
  }
}

// Processes two rows of the triangle at a time.
HWY_INLINE BoxSums whiten_box_means(const PlaceBox& box,
                                    const BoxBurst& burst,
                                    const BoxVectors& mean) {
  BoxSums sums{hn::Zero(kLanes), {no_sum(), no_sum(), no_sum()}};
  const std::size_t size = box.dimension();
  const std::size_t stride = 2 * size;
  const float* row = box.whitener();
  const float* observed = burst.whitened.data();
  for (std::size_t i = 0; i < size; i += 2) {
    const bool is_pair = i + 1 < size;
    const float* next = row + 2 * (i + 1);
    Products first = no_products();
    Products second = no_products();
    if (is_pair) {
      for (std::size_t j = 0; j <= i; ++j) {
        const Complex x = of_box_lanes(mean[j]);
        add(row[2 * j], row[2 * j + 1], x, first);
        add(next[2 * j], next[2 * j + 1], x, second);
      }
      add(next[2 * (i + 1)], next[2 * (i + 1) + 1], of_box_lanes(mean[i + 1]), second);
    } else {
      for (std::size_t j = 0; j <= i; ++j) {
        add(row[2 * j], row[2 * j + 1], of_box_lanes(mean[j]), first);
      }
    }
    collect_box(sum_of(first), observed + 2 * i, stride, sums);
    if (is_pair) {
      collect_box(sum_of(second), observed + 2 * (i + 1), stride, sums);
    }
    row = next + 2 * (i + 2);
  }
  return sums;
}

HWY_INLINE Vector value_of_box(const PlaceBox& box, const BoxBurst& burst, const BoxVectors& mean) {
  const BoxSums sums = whiten_box_means(box, burst, mean);
  const Vector dimension = hn::Set(kLanes, static_cast<float>(box.dimension()));
  Vector best = best_profile(hn::Set(kLanes, burst.power[0]), sums.along[0], dimension);
  for (std::size_t k = 1; k < kBoxDelays; ++k) {
    best = hn::Max(best, best_profile(hn::Set(kLanes, burst.power[k]), sums.along[k], dimension));
  }
  return hn::Sub(best, sums.power);
}

// `count` numbers from `from` on, the last one repeated.
HWY_INLINE Vector load_box_tail(const float* from, std::size_t count) {
  std::array<float, kLaneCount> copy;
  for (std::size_t i = 0; i < kLaneCount; ++i) {
    copy[i] = from[std::min(i, count - 1)];
  }
  return hn::LoadU(kLanes, copy.data());
}
HWY_INLINE BoxOffsets box_offsets(const BoxPlaces& places, std::size_t n, std::size_t count) {
  BoxOffsets d;
  if (count == hn::Lanes(kLanes)) {
    d.x = hn::LoadU(kLanes, places.x.data() + n);
    d.y = hn::LoadU(kLanes, places.y.data() + n);
    d.z = hn::LoadU(kLanes, places.z.data() + n);
  } else {
    d.x = load_box_tail(places.x.data() + n, count);
    d.y = load_box_tail(places.y.data() + n, count);
    d.z = load_box_tail(places.z.data() + n, count);
  }
  d.square = hn::MulAdd(d.x, d.x, hn::MulAdd(d.y, d.y, hn::Mul(d.z, d.z)));
  return d;
}

void evaluate_places(const PlaceBox& box,
                     const BoxBurst& burst,
                     const BoxPlaces& places,
                     std::span<float> out) {
  BoxPhasors phasors;
  BoxVectors mean;
  const Vector less = hn::Set(kLanes, box.log_determinant);
  const Vector log_obstructed = hn::Set(kLanes, static_cast<float>(kLogObstructed));
  for (std::size_t n = 0; n < out.size(); n += hn::Lanes(kLanes)) {
    const std::size_t count = std::min(out.size() - n, hn::Lanes(kLanes));
    take_box_phasors(box, box_offsets(places, n, count), phasors);
    take_box_means(box, phasors, mean);
    Vector best = value_of_box(box, burst, mean);
    if (box.has_direct) {
      obstruct_box(box, phasors, mean);
      best = hn::Max(best, hn::Add(value_of_box(box, burst, mean), log_obstructed));
    }
    best = hn::Sub(best, less);
    if (count == hn::Lanes(kLanes)) {
      hn::StoreU(best, kLanes, out.data() + n);
    } else {
      std::array<float, kLaneCount> values;
      hn::StoreU(best, kLanes, values.data());
      std::copy_n(values.begin(), count, out.begin() + static_cast<std::ptrdiff_t>(n));
    }
  }
}

// Eight delays of a burst, whitened: their coordinates, power, and likelihood at the middle.
struct BoxWindow {
  BoxVectors whitened;  // [coordinate] of eight delays
  LaneRow power;
  LaneRow value;
};

// y: [coordinate] of eight delays.
HWY_INLINE void whiten_window(const PlaceBox& box, const BoxVectors& y, BoxWindow& out) {
  const std::size_t size = box.dimension();
  const Vector dimension = hn::Set(kLanes, static_cast<float>(size));
  const float* middle = box.middle();
  for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
    const float* w = box.whitener();
    Vector power = hn::Zero(kLanes);
    Complex along = no_sum();
    for (std::size_t i = 0; i < size; ++i) {
      Products sums = no_products();
      for (std::size_t j = 0; j <= i; ++j, w += 2) {
        const Complex x{hn::LoadU(kLanes, y[j].re.data() + t),
                        hn::LoadU(kLanes, y[j].im.data() + t)};
        add(w[0], w[1], x, sums);
      }
      const Complex x = sum_of(sums);
      power = add_box_power(x, power);
      along = add_box_conjugate(x, middle + 2 * i, along);
      hn::StoreU(x.re, kLanes, out.whitened[i].re.data() + t);
      hn::StoreU(x.im, kLanes, out.whitened[i].im.data() + t);
    }
    power = hn::Max(power, hn::Set(kLanes, kMinSinglePower));
    hn::StoreU(power, kLanes, out.power.data() + t);
    hn::StoreU(best_profile(power, along, dimension), kLanes, out.value.data() + t);
  }
}

// Delays first, first + step, ... of the burst. Returns the best of them.
HWY_INLINE std::size_t search_box_window(const PlaceBox& box,
                                         const DelayRows& burst,
                                         std::size_t first,
                                         std::size_t step,
                                         BoxWindow& out) {
  BoxVectors y;
  for (std::size_t i = 0; i < box.dimension(); ++i) {
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      y[i].re[t] = burst.re[i][first + step * t];
      y[i].im[t] = burst.im[i][first + step * t];
    }
  }
  whiten_window(box, y, out);
  const auto best = std::max_element(out.value.begin(), out.value.end());
  return first + step * static_cast<std::size_t>(best - out.value.begin());
}

std::size_t first_of_box_window(std::size_t delay) {
  constexpr std::size_t kBefore = kLaneCount / 2;
  return std::min(delay - std::min(delay, kBefore), ObservedArray::kDelays - kLaneCount);
}

// Returns the number of windows that were whitened.
std::size_t whiten_box_delays(const PlaceBox& box,
                              const DelayRows& burst,
                              std::optional<std::size_t> hint,
                              BoxBurst& out) {
  constexpr std::size_t kStep = ObservedArray::kStride;
  BoxWindow window;
  std::size_t windows = 1;
  if (!hint) {
    hint = search_box_window(box, burst, kStep / 2, kStep, window);
    ++windows;
  }
  std::size_t first = first_of_box_window(*hint);
  out.delay = search_box_window(box, burst, first, 1, window);
  // The best of eight at their end may have a better neighbour.
  const bool is_at_end = out.delay == first || out.delay + 1 == first + kLaneCount;
  if (is_at_end && first_of_box_window(out.delay) != first) {
    first = first_of_box_window(out.delay);
    out.delay = search_box_window(box, burst, first, 1, window);
    ++windows;
  }
  const std::size_t middle =
      std::clamp(out.delay, first + 1, first + kLaneCount - kBoxDelays + 1) - first;
  float* to = out.whitened.data();
  for (std::size_t k = 0; k < kBoxDelays; ++k) {
    const std::size_t t = middle - 1 + k;
    out.power[k] = window.power[t];
    for (std::size_t i = 0; i < box.dimension(); ++i) {
      *to++ = window.whitened[i].re[t];
      *to++ = window.whitened[i].im[t];
    }
  }
  return windows;
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc {
namespace {

HWY_EXPORT(evaluate_places);
HWY_EXPORT(whiten_box_delays);

}  // namespace

void whiten_delays_of_box(const PlaceBox& box,
                          const DelayRows& burst,
                          std::optional<std::size_t> hint,
                          BoxBurst& out) {
  RAYLOC_CHECK(box.is_reachable() && burst.coordinates() == box.dimension());
  const std::size_t windows = HWY_DYNAMIC_DISPATCH(whiten_box_delays)(box, burst, hint, out);
  const std::size_t size = box.dimension();
  WorkDone::add(windows * kLaneCount * (4 * size * (size + 1) + 12 * size + 48),
                windows * size * ((size + 3) * 4 + 2 * kLaneCount) * sizeof(float));
}

void evaluate_places_of_box(const PlaceBox& box,
                            const BoxBurst& burst,
                            const BoxPlaces& places,
                            std::span<float> out) {
  RAYLOC_CHECK(box.is_reachable() && places.x.size() == out.size() &&
               places.y.size() == out.size() && places.z.size() == out.size());
  const std::size_t size = box.dimension();
  const auto [rays, antennas, coordinates] = box.size();
  const std::size_t cases = box.has_direct ? 2 : 1;
  // Per place: phasors, means, whitened means with the delays, gains.
  WorkDone::add(
      out.size() *
          (rays * (50 + 35 * (antennas - 1)) + 8 * rays * size +
           cases * (4 * size * (size + 1) + (4 + 8 * kBoxDelays) * size + 48 * kBoxDelays)),
      box.block().size_bytes() + 2 * kBoxDelays * size * sizeof(float) + 4 * out.size_bytes());
  HWY_DYNAMIC_DISPATCH(evaluate_places)(box, burst, places, out);
}

}  // namespace rayloc
#endif  // HWY_ONCE
