#include "engine/likelihood/lane_kernel.h"

#include "engine/base/check.h"
#include "engine/base/work_done.h"

// Highway compiles this file once for each kind of processor (see trace/cfr_kernel.cpp).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/likelihood/lane_kernel.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "engine/likelihood/lane_gain_inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Adds one coordinate of W x to |W x|^2 and to the projections; `along` points to that coordinate
// of the first vector, each following vector `size` elements further.
HWY_INLINE Vector collect(const Products& sums,
                          Vector power,
                          std::size_t t,
                          const std::complex<float>* along,
                          std::size_t size,
                          std::span<LaneSums> projections) {
  const auto [re, im] = sum_of(sums);
  for (std::size_t k = 0; k < projections.size(); ++k) {
    const std::complex<float> v = along[k * size];
    const Vector v_re = hn::Set(kLanes, v.real());
    const Vector v_im = hn::Set(kLanes, v.imag());
    float* out_re = projections[k].re.data() + t;
    float* out_im = projections[k].im.data() + t;
    hn::StoreU(
        hn::MulAdd(im, v_im, hn::MulAdd(re, v_re, hn::LoadU(kLanes, out_re))), kLanes, out_re);
    hn::StoreU(
        hn::NegMulAdd(im, v_re, hn::MulAdd(re, v_im, hn::LoadU(kLanes, out_im))), kLanes, out_im);
  }
  return hn::MulAdd(im, im, hn::MulAdd(re, re, power));
}

// Processes two rows of the triangle at a time.
void whiten(const std::complex<float>* whitener,
            std::span<const LaneRow> re,
            std::span<const LaneRow> im,
            std::span<const std::complex<float>> along,
            std::span<LaneSums> projections,
            LaneRow& power_out) {
  const std::size_t size = re.size();
  for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
    Vector power = hn::Zero(kLanes);
    const std::complex<float>* row = whitener;
    for (std::size_t i = 0; i < size; i += 2) {
      const bool is_pair = i + 1 < size;
      const std::complex<float>* next = row + i + 1;
      Products first = no_products();
      Products second = no_products();
      for (std::size_t j = 0; j <= i; ++j) {
        const Complex x{hn::LoadU(kLanes, re[j].data() + t), hn::LoadU(kLanes, im[j].data() + t)};
        add(row[j].real(), row[j].imag(), x, first);
        if (is_pair) {
          add(next[j].real(), next[j].imag(), x, second);
        }
      }
      power = collect(first, power, t, along.data() + i, size, projections);
      if (is_pair) {
        const Complex x{hn::LoadU(kLanes, re[i + 1].data() + t),
                        hn::LoadU(kLanes, im[i + 1].data() + t)};
        add(next[i + 1].real(), next[i + 1].imag(), x, second);
        power = collect(second, power, t, along.data() + i + 1, size, projections);
      }
      row = next + i + 2;
    }
    hn::StoreU(power, kLanes, power_out.data() + t);
  }
}

// Processes `kCount` coordinates from the first on, with the sums held in registers.
template <std::size_t kCount>
HWY_INLINE void add_rotated_to(std::span<const RotatedMean> terms,
                               std::size_t first,
                               std::size_t t,
                               LaneRow* re,
                               LaneRow* im) {
  std::array<Vector, kCount> sum_re;
  std::array<Vector, kCount> sum_im;
  for (std::size_t i = 0; i < kCount; ++i) {
    sum_re[i] = hn::LoadU(kLanes, re[first + i].data() + t);
    sum_im[i] = hn::LoadU(kLanes, im[first + i].data() + t);
  }
  for (const RotatedMean& term : terms) {
    const Vector a = hn::Set(kLanes, term.turn.real());
    const Vector b = hn::Set(kLanes, term.turn.imag());
    const Vector y_re = hn::LoadU(kLanes, term.turns->re.data() + t);
    const Vector y_im = hn::LoadU(kLanes, term.turns->im.data() + t);
    const Vector turn_re = hn::NegMulAdd(b, y_im, hn::Mul(a, y_re));
    const Vector turn_im = hn::MulAdd(b, y_re, hn::Mul(a, y_im));
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vector c = hn::Set(kLanes, term.mean[first + i].real());
      const Vector d = hn::Set(kLanes, term.mean[first + i].imag());
      sum_re[i] = hn::NegMulAdd(turn_im, d, hn::MulAdd(turn_re, c, sum_re[i]));
      sum_im[i] = hn::MulAdd(turn_im, c, hn::MulAdd(turn_re, d, sum_im[i]));
    }
  }
  for (std::size_t i = 0; i < kCount; ++i) {
    hn::StoreU(sum_re[i], kLanes, re[first + i].data() + t);
    hn::StoreU(sum_im[i], kLanes, im[first + i].data() + t);
  }
}

void add_rotated(std::span<const RotatedMean> terms, std::span<LaneRow> re, std::span<LaneRow> im) {
  for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
    std::size_t first = 0;
    for (; first + 6 <= re.size(); first += 6) {
      add_rotated_to<6>(terms, first, t, re.data(), im.data());
    }
    for (; first + 2 <= re.size(); first += 2) {
      add_rotated_to<2>(terms, first, t, re.data(), im.data());
    }
    if (first < re.size()) {
      add_rotated_to<1>(terms, first, t, re.data(), im.data());
    }
  }
}

void at_best_gain(const LaneRow& power, const LaneSums& along, float dimension, LaneRow& out) {
  const Vector d = hn::Set(kLanes, dimension);
  for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
    const Vector a = hn::LoadU(kLanes, power.data() + t);
    hn::StoreU(best_profile(a, load(along, t), d), kLanes, out.data() + t);
  }
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc {
namespace {

HWY_EXPORT(whiten);
HWY_EXPORT(add_rotated);
HWY_EXPORT(at_best_gain);

void fetch_lines(const void* block, std::size_t bytes) {
  constexpr std::size_t kLine = 64;  // [bytes], of a cache line
  for (std::size_t i = 0; i < bytes; i += kLine) {
    __builtin_prefetch(static_cast<const std::byte*>(block) + i);
  }
}

}  // namespace

LaneRow whiten(const std::complex<float>* whitener,
               std::span<const LaneRow> re,
               std::span<const LaneRow> im,
               std::span<const std::complex<float>> along,
               std::span<LaneSums> sums) {
  RAYLOC_CHECK(re.size() == im.size() && along.size() == sums.size() * re.size());
  for (LaneSums& sum : sums) {
    sum = {};
  }
  LaneRow power{};
  const std::size_t size = re.size();
  WorkDone::add(kLaneCount * size * (4 * (size + 1) + 6 + 8 * sums.size()),
                size * (size + 1) / 2 * sizeof(*whitener) + re.size_bytes() + im.size_bytes() +
                    along.size_bytes());
  HWY_DYNAMIC_DISPATCH(whiten)(whitener, re, im, along, sums, power);
  return power;
}

void fetch(std::span<const std::complex<float>> whitener) {
  fetch_lines(whitener.data(), whitener.size_bytes());
}

void fetch(std::span<const float> block) { fetch_lines(block.data(), block.size_bytes()); }

LaneRow at_best_gain(const LaneRow& power, const LaneSums& along, std::size_t dimension) {
  LaneRow values{};
  WorkDone::add(48 * kLaneCount, sizeof(power) + sizeof(along) + sizeof(values));
  HWY_DYNAMIC_DISPATCH(at_best_gain)(power, along, static_cast<float>(dimension), values);
  return values;
}

void add_rotated(std::span<const RotatedMean> terms, std::span<LaneRow> re, std::span<LaneRow> im) {
  RAYLOC_CHECK(re.size() == im.size());
  WorkDone::add(kLaneCount * terms.size() * (6 + 8 * re.size()),
                terms.size() * (sizeof(LaneSums) + re.size() * sizeof(*terms.front().mean)) +
                    2 * (re.size_bytes() + im.size_bytes()));
  HWY_DYNAMIC_DISPATCH(add_rotated)(terms, re, im);
}

}  // namespace rayloc
#endif  // HWY_ONCE
