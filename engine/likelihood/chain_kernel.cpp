#include "engine/likelihood/chain_kernel.h"

#include "engine/base/check.h"

// Highway compiles this file once for each kind of processor (see trace/cfr_kernel.cpp).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/likelihood/chain_kernel.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#include "engine/likelihood/lane_gain_inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayloc::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kMinPower = 1e-12F;  // a ratio, chosen: keeps divisions from zero

HWY_INLINE void store(const Complex& value, std::size_t t, LaneSums& sums) {
  hn::StoreU(value.re, kLanes, sums.re.data() + t);
  hn::StoreU(value.im, kLanes, sums.im.data() + t);
}
// sum + a b
HWY_INLINE Complex add_product(std::complex<float> a, const Complex& b, const Complex& sum) {
  const Vector re = hn::Set(kLanes, a.real());
  const Vector im = hn::Set(kLanes, a.imag());
  return {hn::NegMulAdd(im, b.im, hn::MulAdd(re, b.re, sum.re)),
          hn::MulAdd(im, b.re, hn::MulAdd(re, b.im, sum.im))};
}
// sum + conj(a) b
HWY_INLINE Complex add_conjugate(const Complex& a, const Complex& b, const Complex& sum) {
  return {hn::MulAdd(a.im, b.im, hn::MulAdd(a.re, b.re, sum.re)),
          hn::NegMulAdd(a.im, b.re, hn::MulAdd(a.re, b.im, sum.im))};
}

void whiten_chains(const std::complex<float>* whitener,
                   std::span<const LaneRow> re,
                   std::span<const LaneRow> im,
                   std::span<const std::complex<float>> means,
                   std::size_t chains,
                   ChainProducts& out) {
  const std::size_t size = re.size();
  const std::size_t of_chain = size / chains;
  const std::size_t mean_count = means.size() / size;
  for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
    const std::complex<float>* w = whitener;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t last = i / of_chain;
      std::array<Complex, kMaxChains> u;
      for (std::size_t m = 0; m <= last; ++m) {
        u[m] = no_sum();
        const std::size_t end = m == last ? i + 1 : (m + 1) * of_chain;
        for (std::size_t j = m * of_chain; j < end; ++j, ++w) {
          const Complex x = {hn::LoadU(kLanes, re[j].data() + t),
                             hn::LoadU(kLanes, im[j].data() + t)};
          u[m] = add_product(*w, x, u[m]);
        }
      }
      for (std::size_t n = 0; n <= last; ++n) {
        float* power = out.power[n].data() + t;
        hn::StoreU(
            hn::MulAdd(u[n].im, u[n].im, hn::MulAdd(u[n].re, u[n].re, hn::LoadU(kLanes, power))),
            kLanes,
            power);
        for (std::size_t m = 0; m < n; ++m) {
          LaneSums& cross = out.cross[chain_pair(m, n)];
          store(add_conjugate(u[m], u[n], load(cross, t)), t, cross);
        }
        for (std::size_t k = 0; k < mean_count; ++k) {
          LaneSums& along = out.along[k][n];
          store(add_product(std::conj(means[k * size + i]), u[n], load(along, t)), t, along);
        }
      }
    }
  }
}

// Sums over all chains but the last, in one state of theirs.
struct Others {
  Vector power;   // including that of the last chain
  Complex cross;  // with the last chain, conj(z_m) u_m^H u_last
  Complex along;
};

HWY_INLINE Others others_of(const ChainProducts& products,
                            const TurnQuestion& question,
                            std::size_t state,
                            std::size_t t) {
  const std::size_t last = question.chains - 1;
  std::array<std::complex<float>, kMaxChains> z;
  z[0] = 1.0F;
  for (std::size_t m = last; m-- > 1; state /= question.turns.size()) {
    z[m] = question.turns[state % question.turns.size()];
  }
  Others sum = {hn::LoadU(kLanes, products.power[last].data() + t), no_sum(), no_sum()};
  for (std::size_t n = 0; n < last; ++n) {
    sum.power = hn::Add(sum.power, hn::LoadU(kLanes, products.power[n].data() + t));
    for (std::size_t m = 0; m < n; ++m) {
      const Complex product =
          add_product(std::conj(z[m]) * z[n], load(products.cross[chain_pair(m, n)], t), no_sum());
      sum.power = hn::MulAdd(hn::Set(kLanes, 2.0F), product.re, sum.power);
    }
    sum.cross =
        add_product(std::conj(z[n]), load(products.cross[chain_pair(n, last)], t), sum.cross);
    sum.along = add_product(z[n], load(products.along[question.mean][n], t), sum.along);
  }
  return sum;
}

void best_of_turns(const ChainProducts& products,
                   const TurnQuestion& question,
                   std::span<float> best,
                   LaneRow& highest) {
  const Vector dimension = hn::Set(kLanes, static_cast<float>(question.dimension));
  const Vector offset = hn::Set(kLanes, question.offset);
  const std::size_t last = question.chains - 1;
  const std::size_t turns = last == 0 ? 1 : question.turns.size();
  for (std::size_t t = 0; t < kLaneCount; t += hn::Lanes(kLanes)) {
    const Complex own = load(products.along[question.mean][last], t);
    Vector top = hn::LoadU(kLanes, highest.data() + t);
    for (std::size_t first = 0; first < best.size(); first += turns) {
      const Others others = others_of(products, question, first / turns, t);
      for (std::size_t turn = 0; turn < turns; ++turn) {
        const std::complex<float> z = last == 0 ? 1.0F : question.turns[turn];
        const Vector doubled = hn::Set(kLanes, 2.0F);
        const Vector product = hn::NegMulAdd(hn::Set(kLanes, z.imag()),
                                             others.cross.im,
                                             hn::Mul(hn::Set(kLanes, z.real()), others.cross.re));
        const Vector power =
            hn::Max(hn::MulAdd(doubled, product, others.power), hn::Set(kLanes, kMinPower));
        const Complex along = add_product(z, own, others.along);
        const Vector value = hn::Add(best_profile(power, along, dimension), offset);
        top = hn::Max(top, value);
        float& state = best[first + turn];
        state = HWY_MAX(state, hn::GetLane(hn::MaxOfLanes(kLanes, value)));
      }
    }
    hn::StoreU(top, kLanes, highest.data() + t);
  }
}

}  // namespace rayloc::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayloc {
namespace {

HWY_EXPORT(whiten_chains);
HWY_EXPORT(best_of_turns);

}  // namespace

ChainProducts whiten_chains(const std::complex<float>* whitener,
                            std::span<const LaneRow> re,
                            std::span<const LaneRow> im,
                            std::span<const std::complex<float>> means,
                            std::size_t chains) {
  RAYLOC_CHECK(re.size() == im.size() && chains > 0 && chains <= kMaxChains &&
               re.size() % chains == 0 && means.size() <= 2 * re.size());
  ChainProducts products;
  HWY_DYNAMIC_DISPATCH(whiten_chains)(whitener, re, im, means, chains, products);
  return products;
}

void best_of_turns(const ChainProducts& products,
                   const TurnQuestion& question,
                   std::span<float> best,
                   LaneRow& highest) {
  HWY_DYNAMIC_DISPATCH(best_of_turns)(products, question, best, highest);
}

}  // namespace rayloc
#endif  // HWY_ONCE
