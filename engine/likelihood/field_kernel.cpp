#include "engine/likelihood/field_kernel.h"

#include "engine/base/check.h"
#include "engine/base/work_done.h"

// Highway compiles this file once for each kind of processor (see trace/cfr_kernel.cpp).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/likelihood/field_kernel.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "engine/likelihood/lane_gain_inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Wide = hn::CappedTag<float, kFieldRays>;
constexpr Wide kWide;  // lanes of a vector register of the machine, up to 16
using WideVector = hn::Vec<Wide>;

template <class V>
struct Pair {
  V re;
  V im;
};
template <class Sums>
HWY_INLINE void store(const Complex& value, Sums& to, std::size_t t) {
  hn::StoreU(value.re, kLanes, to.re.data() + t);
  hn::StoreU(value.im, kLanes, to.im.data() + t);
}
// sum + a x
template <class D, class P>
HWY_INLINE P add_times(D d, float a_re, float a_im, const P& x, const P& sum) {
  const auto re = hn::Set(d, a_re);
  const auto im = hn::Set(d, a_im);
  return {hn::NegMulAdd(im, x.im, hn::MulAdd(re, x.re, sum.re)),
          hn::MulAdd(im, x.re, hn::MulAdd(re, x.im, sum.im))};
}
// sum + conj(x) a
template <class D, class P>
HWY_INLINE P add_conjugate_times(D d, float a_re, float a_im, const P& x, const P& sum) {
  const auto re = hn::Set(d, a_re);
  const auto im = hn::Set(d, a_im);
  return {hn::MulAdd(im, x.im, hn::MulAdd(re, x.re, sum.re)),
          hn::NegMulAdd(re, x.im, hn::MulAdd(im, x.re, sum.im))};
}
using WidePair = Pair<WideVector>;
HWY_INLINE WidePair load(const RaySums& sums, std::size_t t) {
  return {hn::LoadU(kWide, sums.re.data() + t), hn::LoadU(kWide, sums.im.data() + t)};
}
HWY_INLINE void store(const WidePair& value, RaySums& to, std::size_t t) {
  hn::StoreU(value.re, kWide, to.re.data() + t);
  hn::StoreU(value.im, kWide, to.im.data() + t);
}
HWY_INLINE WidePair no_wide_sum() { return {hn::Zero(kWide), hn::Zero(kWide)}; }

void turn_and_whiten(std::span<const std::complex<float>> turn,
                     const Bidiagonal& of,
                     std::span<const LaneRow> re,
                     std::span<const LaneRow> im,
                     std::span<LaneSums> out) {
  const std::size_t size = re.size();
  for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
    Complex before = no_sum();
    for (std::size_t i = 0; i < size; ++i) {
      Complex even = no_sum();
      Complex odd = no_sum();
      const std::complex<float>* row = turn.data() + i * size;
      for (std::size_t j = 0; j < size; ++j) {
        const Complex y{hn::LoadU(kLanes, re[j].data() + t), hn::LoadU(kLanes, im[j].data() + t)};
        Complex& sum = j % 2 == 0 ? even : odd;
        sum = add_times(kLanes, row[j].real(), row[j].imag(), y, sum);
      }
      const Vector below = hn::Set(kLanes, i > 0 ? of.below[i - 1] : 0.0F);
      before = {hn::NegMulAdd(below, before.re, hn::Add(even.re, odd.re)),
                hn::NegMulAdd(below, before.im, hn::Add(even.im, odd.im))};
      const Vector scale = hn::Set(kLanes, of.scale[i]);
      store({hn::Mul(scale, before.re), hn::Mul(scale, before.im)}, out[i], t);
    }
  }
}

void whiten_rays(const Bidiagonal& of, std::span<const LaneSums> rays, std::span<RaySums> out) {
  const std::size_t blocks = rays.size() / out.size();
  for (std::size_t ray = 0; ray < blocks * kLaneCount; ray += hn::Lanes(kLanes)) {
    const LaneSums* block = rays.data() + ray / kLaneCount;
    Complex before = no_sum();
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vector below = hn::Set(kLanes, i > 0 ? of.below[i - 1] : 0.0F);
      const Complex next = load(block[i * blocks], ray % kLaneCount);
      before = {hn::NegMulAdd(below, before.re, next.re), hn::NegMulAdd(below, before.im, next.im)};
      const Vector scale = hn::Set(kLanes, of.scale[i]);
      store({hn::Mul(scale, before.re), hn::Mul(scale, before.im)}, out[i], ray);
    }
  }
}

// Processes four rays against all others at a time.
void gram_of(std::span<const RaySums> z, FieldTerms& terms) {
  for (std::size_t p = 0; p < terms.rays; p += 4) {
    for (std::size_t t = 0; t < kFieldRays; t += hn::Lanes(kWide)) {
      WidePair a = no_wide_sum();
      WidePair b = no_wide_sum();
      WidePair c = no_wide_sum();
      WidePair d = no_wide_sum();
      for (const RaySums& one : z) {
        const WidePair x = load(one, t);
        a = add_times(kWide, one.re[p], -one.im[p], x, a);
        b = add_times(kWide, one.re[p + 1], -one.im[p + 1], x, b);
        c = add_times(kWide, one.re[p + 2], -one.im[p + 2], x, c);
        d = add_times(kWide, one.re[p + 3], -one.im[p + 3], x, d);
      }
      store(a, terms.gram[p], t);
      store(b, terms.gram[p + 1], t);
      store(c, terms.gram[p + 2], t);
      store(d, terms.gram[p + 3], t);
    }
  }
}

void along_of(std::span<const RaySums> z, std::span<const std::complex<float>> x, RaySums& out) {
  for (std::size_t t = 0; t < kFieldRays; t += hn::Lanes(kWide)) {
    WidePair even = no_wide_sum();
    WidePair odd = no_wide_sum();
    for (std::size_t i = 0; i < x.size(); ++i) {
      WidePair& sum = i % 2 == 0 ? even : odd;
      sum = add_conjugate_times(kWide, x[i].real(), x[i].imag(), load(z[i], t), sum);
    }
    store(WidePair{hn::Add(even.re, odd.re), hn::Add(even.im, odd.im)}, out, t);
  }
}

// best_profile() as a function of v = |b|^2 / a and the logarithm of a.
HWY_INLINE WideVector profile_of(const WidePair& b,
                                 float power_inverse,
                                 float log_power,
                                 float dimension) {
  const WideVector b2 = hn::MulAdd(b.im, b.im, hn::Mul(b.re, b.re));
  const WideVector v = hn::Mul(b2, hn::Set(kWide, power_inverse));
  const WideVector s = hn::Sqrt(v);
  const WideVector root = hn::Sqrt(hn::Add(v, hn::Set(kWide, 4.0F * dimension)));
  const WideVector y = hn::Mul(hn::Set(kWide, 0.5F), hn::Add(s, root));
  const WideVector linear = hn::Mul(y, hn::Sub(hn::Add(s, s), y));
  return hn::Sub(hn::MulAdd(hn::Set(kWide, 2.0F * dimension), hn::Log(kWide, y), linear),
                 hn::Set(kWide, dimension * log_power));
}

// Phasors of two rows of places: [ray].
struct Phasors {
  std::array<std::array<float, 2 * kLaneCount>, kFieldRays> re;
  std::array<std::array<float, 2 * kLaneCount>, kFieldRays> im;

  HWY_INLINE WidePair of(std::size_t p, std::size_t t) const {
    return {hn::LoadU(kWide, re[p].data() + t), hn::LoadU(kWide, im[p].data() + t)};
  }
};

HWY_INLINE void take_phasors(const FieldRow& row,
                             std::size_t rays,
                             std::size_t first,
                             Phasors& out) {
  RaySums turn;
  for (std::size_t p = 0; p < rays; p += hn::Lanes(kLanes)) {
    const Complex a = load(row.by_x[p / kLaneCount], p % kLaneCount);
    const Complex b = load(row.by_z[p / kLaneCount], p % kLaneCount);
    store(Complex{hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re)),
                  hn::MulAdd(a.im, b.re, hn::Mul(a.re, b.im))},
          turn,
          p);
  }
  for (std::size_t p = 0; p < rays; ++p) {
    for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
      const Complex phasor =
          add_times(kLanes, turn.re[p], turn.im[p], load(row.by_y[p], t), no_sum());
      hn::StoreU(phasor.re, kLanes, out.re[p].data() + first + t);
      hn::StoreU(phasor.im, kLanes, out.im[p].data() + first + t);
    }
  }
}

// Log-likelihood of the places: line of sight clear, and obstructed if it exists.
HWY_INLINE WideVector value_of(
    const FieldTerms& terms, std::size_t delays, float own, const Phasors& phasor, std::size_t t) {
  WideVector power = hn::Set(kWide, own);
  WideVector direct = hn::Zero(kWide);  // twice the terms of the first ray with the others
  for (std::size_t p = 0; p + 1 < terms.rays; ++p) {
    const RaySums& gram = terms.gram[p];
    WidePair a = no_wide_sum();
    WidePair b = no_wide_sum();
    std::size_t q = p + 1;
    for (; q + 1 < terms.rays; q += 2) {
      a = add_times(kWide, gram.re[q], gram.im[q], phasor.of(q, t), a);
      b = add_times(kWide, gram.re[q + 1], gram.im[q + 1], phasor.of(q + 1, t), b);
    }
    if (q < terms.rays) {
      a = add_times(kWide, gram.re[q], gram.im[q], phasor.of(q, t), a);
    }
    const WidePair here = phasor.of(p, t);
    const WideVector half =
        hn::MulAdd(here.im, hn::Add(a.im, b.im), hn::Mul(here.re, hn::Add(a.re, b.re)));
    const WideVector both = hn::Add(half, half);
    power = hn::Add(power, both);
    direct = p == 0 ? both : direct;
  }
  WideVector best = hn::Zero(kWide);
  WideVector best_obstructed = hn::Zero(kWide);
  for (std::size_t k = 0; k < delays; ++k) {
    const RaySums& along = terms.along[k];
    const WidePair first =
        add_conjugate_times(kWide, along.re[0], along.im[0], phasor.of(0, t), no_wide_sum());
    WidePair even = first;
    WidePair odd = no_wide_sum();
    for (std::size_t p = 1; p < terms.rays; ++p) {
      WidePair& sum = p % 2 == 0 ? even : odd;
      sum = add_conjugate_times(kWide, along.re[p], along.im[p], phasor.of(p, t), sum);
    }
    const WidePair b{hn::Add(even.re, odd.re), hn::Add(even.im, odd.im)};
    const WideVector open =
        profile_of(b, terms.power_inverse[k], terms.log_power[k], terms.dimension);
    best = k == 0 ? open : hn::Max(best, open);
    if (terms.has_direct) {
      const WideVector obstructed =
          profile_of(WidePair{hn::Sub(b.re, first.re), hn::Sub(b.im, first.im)},
                     terms.power_inverse[k],
                     terms.log_power[k],
                     terms.dimension);
      best_obstructed = k == 0 ? obstructed : hn::Max(best_obstructed, obstructed);
    }
  }
  WideVector value = hn::Sub(best, power);
  if (terms.has_direct) {
    const WideVector obstructed_power =
        hn::Sub(hn::Sub(power, direct), hn::Set(kWide, terms.gram[0].re[0]));
    value = hn::Max(
        value,
        hn::Add(hn::Sub(best_obstructed, obstructed_power), hn::Set(kWide, terms.log_obstructed)));
  }
  return hn::Sub(value, hn::Set(kWide, terms.less));
}

void field_rows(const FieldTerms& terms,
                std::size_t delays,
                std::span<const FieldRow> rows,
                std::span<LaneRow> out) {
  Phasors phasor;
  float own = 0.0F;
  for (std::size_t p = 0; p < terms.rays; ++p) {
    own += terms.gram[p].re[p];
  }
  for (std::size_t n = 0; n < rows.size(); n += 2) {
    const std::size_t next = n + 1 < rows.size() ? n + 1 : n;
    take_phasors(rows[n], terms.rays, 0, phasor);
    take_phasors(rows[next], terms.rays, kLaneCount, phasor);
    std::array<float, 2 * kLaneCount> values;
    for (std::size_t t = 0; t < values.size(); t += hn::Lanes(kWide)) {
      hn::StoreU(value_of(terms, delays, own, phasor, t), kWide, values.data() + t);
    }
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      out[n][lane] = values[lane];
      out[next][lane] = values[next == n ? lane : kLaneCount + lane];
    }
  }
}

void fuse_rows(std::span<const FusedArray> arrays, std::span<LaneRow> mass) {
  float nothing = 1.0F;
  for (const FusedArray& one : arrays) {
    nothing *= one.wrong;
  }
  for (std::size_t n = 0; n < mass.size(); ++n) {
    for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
      Vector product = hn::Set(kLanes, 1.0F);
      for (const FusedArray& one : arrays) {
        const Vector l = hn::LoadU(kLanes, one.log_likelihood[n].data() + t);
        const Vector x = hn::MulAdd(l, hn::Set(kLanes, one.exponent), hn::Set(kLanes, -one.shift));
        const Vector sixteenth = hn::Exp(kLanes, hn::Mul(x, hn::Set(kLanes, 1.0F / 16.0F)));
        const Vector eighth = hn::Mul(sixteenth, sixteenth);
        const Vector quarter = hn::Mul(eighth, eighth);
        const Vector half = hn::Mul(quarter, quarter);
        Vector sum = hn::Set(kLanes, one.wrong);
        sum = hn::MulAdd(sixteenth, hn::Set(kLanes, one.sixteenth), sum);
        sum = hn::MulAdd(quarter, hn::Set(kLanes, one.quarter), sum);
        sum = hn::MulAdd(hn::Mul(half, half), hn::Set(kLanes, one.right), sum);
        product = hn::Mul(product, sum);
      }
      const Vector left = hn::Max(hn::Sub(product, hn::Set(kLanes, nothing)), hn::Zero(kLanes));
      hn::StoreU(left, kLanes, mass[n].data() + t);
    }
  }
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc {
namespace {

HWY_EXPORT(turn_and_whiten);
HWY_EXPORT(whiten_rays);
HWY_EXPORT(gram_of);
HWY_EXPORT(along_of);
HWY_EXPORT(field_rows);
HWY_EXPORT(fuse_rows);

}  // namespace

void turn_and_whiten(std::span<const std::complex<float>> turn,
                     const Bidiagonal& of,
                     std::span<const LaneRow> re,
                     std::span<const LaneRow> im,
                     std::span<LaneSums> out) {
  RAYLOC_CHECK(re.size() == im.size() && re.size() == out.size() &&
               turn.size() == re.size() * re.size());
  WorkDone::add(kLaneCount * re.size() * (8 * re.size() + 6),
                turn.size_bytes() + re.size_bytes() + im.size_bytes() + out.size_bytes());
  HWY_DYNAMIC_DISPATCH(turn_and_whiten)(turn, of, re, im, out);
}

void whiten_rays(const Bidiagonal& of, std::span<const LaneSums> rays, std::span<RaySums> out) {
  RAYLOC_CHECK(out.size() == of.scale.size() && rays.size() % out.size() == 0 &&
               rays.size() <= out.size() * ray_blocks(kFieldRays));
  WorkDone::add(6 * kLaneCount * rays.size(), 2 * rays.size_bytes());
  HWY_DYNAMIC_DISPATCH(whiten_rays)(of, rays, out);
}

void gram_of(std::span<const RaySums> z, FieldTerms& terms) {
  WorkDone::add(8 * kFieldRays * terms.rays * z.size(),
                z.size_bytes() + terms.rays * sizeof(RaySums));
  HWY_DYNAMIC_DISPATCH(gram_of)(z, terms);
}

RaySums along_of(std::span<const RaySums> z, std::span<const std::complex<float>> x) {
  RAYLOC_CHECK(z.size() == x.size());
  RaySums out;
  WorkDone::add(8 * kFieldRays * z.size(), z.size_bytes() + x.size_bytes() + sizeof(out));
  HWY_DYNAMIC_DISPATCH(along_of)(z, x, out);
  return out;
}

void field_rows(const FieldTerms& terms,
                std::size_t delays,
                std::span<const FieldRow> rows,
                std::span<LaneRow> out) {
  RAYLOC_CHECK(rows.size() == out.size() && terms.rays > 0 && delays > 0 && delays <= terms.delays);
  // Per place: phasors of rays, half of the Gram matrix, the delays.
  const std::size_t rays = terms.rays;
  WorkDone::add(
      rows.size() *
          (6 * kLaneCount * ray_blocks(rays) +
           kLaneCount * (6 * rays + 4 * rays * (rays - 1) +
                         delays * (8 * rays + 48 * std::size_t{terms.has_direct ? 2U : 1U}))),
      rows.size() * (2 * ray_blocks(rays) + rays) * sizeof(LaneSums) +
          (rays + delays) * sizeof(RaySums) + out.size_bytes());
  HWY_DYNAMIC_DISPATCH(field_rows)(terms, delays, rows, out);
}

void fuse_rows(std::span<const FusedArray> arrays, std::span<LaneRow> mass) {
  WorkDone::add(mass.size() * kLaneCount * (23 * arrays.size() + 2),
                mass.size_bytes() * (arrays.size() + 1));
  HWY_DYNAMIC_DISPATCH(fuse_rows)(arrays, mass);
}

}  // namespace rayloc
#endif  // HWY_ONCE
