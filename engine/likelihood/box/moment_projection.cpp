#include "engine/likelihood/box/moment_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/base/work_done.h"
#include "engine/likelihood/box/box_factor.h"
#include "engine/likelihood/lane_kernel.h"

// Highway compiles this file once for each kind of processor (see trace/cfr_kernel.cpp).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/likelihood/box/moment_projection.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using MomentLanes = hn::CappedTag<float, kLaneCount>;
using MomentVector = hn::Vec<MomentLanes>;
constexpr MomentLanes kMomentLanes;

// Multiplies a vector of tones in place.
HWY_INLINE void rotate_tones(MomentVector x_re,
                             MomentVector x_im,
                             MomentVector by_re,
                             MomentVector by_im,
                             float* re,
                             float* im) {
  hn::StoreU(hn::NegMulAdd(x_im, by_im, hn::Mul(x_re, by_re)), kMomentLanes, re);
  hn::StoreU(hn::MulAdd(x_im, by_re, hn::Mul(x_re, by_im)), kMomentLanes, im);
}

HWY_INLINE float sum_of_tones(MomentVector x) {
  return hn::GetLane(hn::SumOfLanes(kMomentLanes, x));
}

// The power of the sum over the tones, all antennas together; then moves the array to the next
// delay.
template <std::size_t kAntennas>
HWY_INLINE float take_first_power(const MomentProjection::Tables& tables,
                                  MomentProjection::Tones& h) {
  std::array<MomentVector, kAntennas> sum_re;
  std::array<MomentVector, kAntennas> sum_im;
  for (std::size_t m = 0; m < kAntennas; ++m) {
    sum_re[m] = hn::Zero(kMomentLanes);
    sum_im[m] = hn::Zero(kMomentLanes);
  }
  for (std::size_t k = 0; k < tables.stride; k += hn::Lanes(kMomentLanes)) {
    const MomentVector by_re = hn::LoadU(kMomentLanes, tables.to_next.re.data() + k);
    const MomentVector by_im = hn::LoadU(kMomentLanes, tables.to_next.im.data() + k);
    for (std::size_t m = 0; m < kAntennas; ++m) {
      float* re = h.re.data() + m * tables.stride + k;
      float* im = h.im.data() + m * tables.stride + k;
      const MomentVector x_re = hn::LoadU(kMomentLanes, re);
      const MomentVector x_im = hn::LoadU(kMomentLanes, im);
      sum_re[m] = hn::Add(sum_re[m], x_re);
      sum_im[m] = hn::Add(sum_im[m], x_im);
      rotate_tones(x_re, x_im, by_re, by_im, re, im);
    }
  }
  float power = 0.0F;
  for (std::size_t m = 0; m < kAntennas; ++m) {
    const float re = sum_of_tones(sum_re[m]);
    const float im = sum_of_tones(sum_im[m]);
    power += re * re + im * im;
  }
  return power;
}

template <std::size_t kAntennas>
HWY_INLINE std::size_t search_first(const MomentProjection::Tables& tables,
                                    MomentProjection::Tones& h) {
  float best_power = -1.0F;
  std::size_t best = 0;
  for (std::size_t i = 0; i < tables.delays; ++i) {
    const float power = take_first_power<kAntennas>(tables, h);
    if (power > best_power) {
      best_power = power;
      best = i;
    }
  }
  return best;
}

// The delay with most power in the sum over the tones; h is changed.
std::size_t first_delay_of(const MomentProjection::Tables& tables, MomentProjection::Tones& h) {
  switch (tables.antennas) {
    case 1:
      return search_first<1>(tables, h);
    case 2:
      return search_first<2>(tables, h);
    case 3:
      return search_first<3>(tables, h);
    default:
      static_assert(kMaxBoxAntennas == 4);
      return search_first<4>(tables, h);
  }
}

// `kCount` coordinates of one antenna from the first on, with the sums in registers: conj(basis) h.
// re, im: [coordinate][delay], at the delay.
template <std::size_t kCount>
HWY_INLINE void take_coordinates(const MomentProjection::Tables& tables,
                                 const float* h_re,
                                 const float* h_im,
                                 std::size_t first,
                                 float* re,
                                 float* im) {
  std::array<MomentVector, kCount> sum_re;
  std::array<MomentVector, kCount> sum_im;
  for (std::size_t i = 0; i < kCount; ++i) {
    sum_re[i] = hn::Zero(kMomentLanes);
    sum_im[i] = hn::Zero(kMomentLanes);
  }
  const float* basis_re = tables.basis.re.data() + first * tables.stride;
  const float* basis_im = tables.basis.im.data() + first * tables.stride;
  for (std::size_t k = 0; k < tables.stride; k += hn::Lanes(kMomentLanes)) {
    const MomentVector x_re = hn::LoadU(kMomentLanes, h_re + k);
    const MomentVector x_im = hn::LoadU(kMomentLanes, h_im + k);
    for (std::size_t i = 0; i < kCount; ++i) {
      const MomentVector b_re = hn::LoadU(kMomentLanes, basis_re + i * tables.stride + k);
      const MomentVector b_im = hn::LoadU(kMomentLanes, basis_im + i * tables.stride + k);
      sum_re[i] = hn::MulAdd(b_im, x_im, hn::MulAdd(b_re, x_re, sum_re[i]));
      sum_im[i] = hn::NegMulAdd(b_im, x_re, hn::MulAdd(b_re, x_im, sum_im[i]));
    }
  }
  for (std::size_t i = 0; i < kCount; ++i) {
    re[(first + i) * ObservedArray::kDelays] = sum_of_tones(sum_re[i]);
    im[(first + i) * ObservedArray::kDelays] = sum_of_tones(sum_im[i]);
  }
}

// out: [coordinate][delay]; h is changed.
void project_moment(const MomentProjection::Tables& tables,
                    MomentProjection::Tones& h,
                    MomentProjection::Tones& out) {
  constexpr std::size_t kDelays = ObservedArray::kDelays;
  for (std::size_t t = 0; t < kDelays; ++t) {
    for (std::size_t m = 0; m < tables.antennas; ++m) {
      float* h_re = h.re.data() + m * tables.stride;
      float* h_im = h.im.data() + m * tables.stride;
      float* re = out.re.data() + m * tables.coordinates * kDelays + t;
      float* im = out.im.data() + m * tables.coordinates * kDelays + t;
      std::size_t i = 0;
      for (; i + 6 <= tables.coordinates; i += 6) {
        take_coordinates<6>(tables, h_re, h_im, i, re, im);
      }
      for (; i + 4 <= tables.coordinates; i += 4) {
        take_coordinates<4>(tables, h_re, h_im, i, re, im);
      }
      for (; i < tables.coordinates; ++i) {
        take_coordinates<1>(tables, h_re, h_im, i, re, im);
      }
      for (std::size_t k = 0; k < tables.stride; k += hn::Lanes(kMomentLanes)) {
        rotate_tones(hn::LoadU(kMomentLanes, h_re + k),
                     hn::LoadU(kMomentLanes, h_im + k),
                     hn::LoadU(kMomentLanes, tables.step.re.data() + k),
                     hn::LoadU(kMomentLanes, tables.step.im.data() + k),
                     h_re + k,
                     h_im + k);
      }
    }
  }
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc {
namespace {

// exp(j w delay) of each tone.
MomentProjection::Tones rotation_by(const OfdmGrid& grid, double delay, std::size_t stride) {
  MomentProjection::Tones rotation(stride);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const auto value = std::polar(1.0, 2.0 * std::numbers::pi * grid.offset_hz(k) * delay);
    rotation.re[k] = static_cast<float>(value.real());
    rotation.im[k] = static_cast<float>(value.imag());
  }
  return rotation;
}

// h with unit power, [antenna][tone], moved by `delay`.
MomentProjection::Tones moved(std::span<const std::complex<double>> h,
                              double scale,
                              const OfdmGrid& grid,
                              double delay,
                              std::size_t stride) {
  const std::size_t tones = grid.size();
  std::vector<double> turns(tones);
  for (std::size_t k = 0; k < tones; ++k) {
    turns[k] = -grid.offset_hz(k) * delay;
  }
  std::vector<double> re(tones);
  std::vector<double> im(tones);
  unit_phasors(turns, re, im);
  MomentProjection::Tones result(h.size() / tones * stride);
  for (std::size_t n = 0; n < h.size(); ++n) {
    const std::size_t k = n % tones;
    const std::size_t at = n / tones * stride + k;
    const std::complex<double> value = scale * h[n];
    result.re[at] = static_cast<float>(value.real() * re[k] - value.imag() * im[k]);
    result.im[at] = static_cast<float>(value.real() * im[k] + value.imag() * re[k]);
  }
  return result;
}

}  // namespace

HWY_EXPORT(first_delay_of);
HWY_EXPORT(project_moment);

MomentProjection::MomentProjection(const OfdmGrid& grid,
                                   const DelayBasis& basis,
                                   std::size_t antennas)
    : grid_(grid) {
  RAYLOC_CHECK(antennas > 0 && antennas <= kMaxBoxAntennas);
  const DelaySearch search = first_delay_search(grid);
  delay_step_ = search.step;
  tables_.antennas = antennas;
  tables_.coordinates = basis.size();
  tables_.stride = (grid.size() + kLaneCount - 1) / kLaneCount * kLaneCount;
  tables_.delays = search.count;
  tables_.basis = Tones(basis.size() * tables_.stride);
  for (std::size_t q = 0; q < basis.size(); ++q) {
    const std::span<const std::complex<double>> vector = basis.vector(q);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      tables_.basis.re[q * tables_.stride + k] = static_cast<float>(vector[k].real());
      tables_.basis.im[q * tables_.stride + k] = static_cast<float>(vector[k].imag());
    }
  }
  tables_.to_next = rotation_by(grid, search.step, tables_.stride);
  tables_.step = rotation_by(grid, -ObservedArray::kDelayStep, tables_.stride);
}

ObservedArray MomentProjection::observe(std::span<const std::complex<double>> h) const {
  RAYLOC_CHECK(h.size() == tables_.antennas * grid_.size());
  const std::size_t dimension = tables_.antennas * tables_.coordinates;
  ObservedArray observed(dimension);
  double power = 0.0;
  for (const std::complex<double>& v : h) {
    power += std::norm(v);
  }
  if (power <= 0.0) {
    return observed;
  }
  const double scale = 1.0 / std::sqrt(power);
  Tones searched = moved(h, scale, grid_, 0.0, tables_.stride);
  const std::size_t first = HWY_DYNAMIC_DISPATCH(first_delay_of)(tables_, searched);
  const double start = static_cast<double>(first) * delay_step_ - ObservedArray::kEarliest;
  Tones from = moved(h, scale, grid_, start, tables_.stride);
  constexpr std::size_t kDelays = ObservedArray::kDelays;
  Tones coordinates(dimension * kDelays);
  HWY_DYNAMIC_DISPATCH(project_moment)(tables_, from, coordinates);
  std::array<double, kDelays> captured{};
  for (std::size_t i = 0; i < dimension; ++i) {
    const auto re = std::span(coordinates.re).subspan(i * kDelays).first<kDelays>();
    const auto im = std::span(coordinates.im).subspan(i * kDelays).first<kDelays>();
    observed.set(i, re, im);
    for (std::size_t t = 0; t < kDelays; ++t) {
      captured[t] += static_cast<double>(re[t] * re[t] + im[t] * im[t]);
    }
  }
  observed.captured = *std::max_element(captured.begin(), captured.end());
  const std::size_t values = tables_.antennas * tables_.stride;
  WorkDone::add(8 * values * (tables_.delays + kDelays * (tables_.coordinates + 1)),
                2 * sizeof(float) * (4 * values + (tables_.coordinates + 2) * tables_.stride));
  return observed;
}

}  // namespace rayloc
#endif  // HWY_ONCE
