// The circular CylinderSection: sums of T_n H_n(k_t rho_in) H_n(k_t rho_out) exp(j n phi).
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/em/cylinder_bessel.h"
#include "engine/em/cylinder_modes.h"
#include "engine/em/cylinder_section.h"
#include "engine/em/cylinder_table.h"

namespace rayloc {
namespace {

using C = Complex<double>;

// Step between samples, in k_t times the radius: the largest, and the smallest for bodies of little
// loss, whose resonances are narrow.
constexpr double kWidestStep = 0.1;
constexpr double kNarrowestStep = 0.02;  // as above, chosen: bounds the size of the table
constexpr std::size_t kMaxOrders = 132;  // cylinder_order_count(kLargestSection), with a reserve

// A resonance is about x |Im eps| / (2 eps) wide.
std::size_t sample_count(double k_radius, const C& relative_permittivity) {
  const double width = 0.5 * k_radius * -relative_permittivity.im / relative_permittivity.re;
  const double step = std::clamp(0.5 * width, kNarrowestStep, kWidestStep);
  return kMinTableSamples +
         static_cast<std::size_t>(std::ceil((1.0 - kLowestCosine) * k_radius / step));
}

ElevationTable mode_table(double k_radius, const C& relative_permittivity, std::size_t orders) {
  const std::size_t count = sample_count(k_radius, relative_permittivity);
  std::vector<std::vector<C>> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    const double cosine = kLowestCosine + share * (1.0 - kLowestCosine);
    const CylinderModes modes =
        circular_modes(k_radius, relative_permittivity, std::min(cosine, 1.0), orders);
    // E_z of eta_0 H_z is odd in the order: the sum of exp(+-j n phi) is 2 j sin(n phi).
    for (std::size_t n = 0; n < orders; ++n) {
      const double twice = n == 0 ? 1.0 : 2.0;
      samples[i].push_back(C{twice, 0.0} * modes.vv[n]);
      samples[i].push_back(C{twice, 0.0} * modes.hh[n]);
      samples[i].push_back(C{0.0, 2.0} * modes.cross[n]);
    }
  }
  return {kLowestCosine, std::move(samples)};
}

class CircularSection final : public CylinderSection {
 public:
  CircularSection(double k_radius, const C& relative_permittivity)
      : orders_(cylinder_order_count(k_radius)),
        table_(mode_table(k_radius, relative_permittivity, orders_)) {
    RAYLOC_CHECK(orders_ + 1 <= kMaxOrders);
  }

 private:
  SectionResponse compute(const SectionRays& rays, bool slopes) const override {
    return slopes ? sum<true>(rays) : sum<false>(rays);
  }

  struct Term {
    C product, slope_in, slope_out;  // of the two Hankel functions
  };
  struct Trig {
    double value, slope;  // cos or sin of n times the angle between the azimuths
  };

  static C scaled(const C& z, double factor) { return {factor * z.re, factor * z.im}; }

  template <bool kSlopes>
  SectionResponse sum(const SectionRays& rays) const {
    std::array<C, kMaxOrders> in;  // Hankel functions, one order more for their slopes
    std::array<C, kMaxOrders> out;
    hankel_orders(rays.kt_rho_in, std::span(in).first(orders_ + 1));
    hankel_orders(rays.kt_rho_out, std::span(out).first(orders_ + 1));
    const ElevationTable::Place place = table_.at(rays.cos_elevation);
    const double turn = rays.phi_out - rays.phi_in;
    const C step{std::cos(turn), std::sin(turn)};

    SectionResponse sum;
    C angle{1.0, 0.0};  // exp(j n turn)
    std::array<C, 3> modes;
    std::array<C, 3> mode_slopes;
    for (std::size_t n = 0; n < orders_; ++n) {
      ElevationTable::read(
          place, 3 * n, modes, kSlopes ? std::span<C>(mode_slopes) : std::span<C>());
      const auto order = static_cast<double>(n);
      Term term{in[n] * out[n], {}, {}};
      if constexpr (kSlopes) {
        term.slope_in = (scaled(in[n], order / rays.kt_rho_in) - in[n + 1]) * out[n];
        term.slope_out = in[n] * (scaled(out[n], order / rays.kt_rho_out) - out[n + 1]);
      }
      const Trig even{angle.re, -order * angle.im};
      const Trig odd{angle.im, order * angle.re};
      add<kSlopes>(sum, kVv, modes[0], mode_slopes[0], term, even);
      add<kSlopes>(sum, kHh, modes[1], mode_slopes[1], term, even);
      add<kSlopes>(sum, kVh, modes[2], mode_slopes[2], term, odd);
      angle = angle * step;
    }
    // eta_0 H_z of E_z is the same with the opposite sign.
    sum.value[kHv] = C{} - sum.value[kVh];
    for (auto& slope : sum.slope) {
      slope[kHv] = C{} - slope[kVh];
    }
    return sum;
  }

  template <bool kSlopes>
  static void add(SectionResponse& sum,
                  std::size_t part,
                  const C& mode,
                  const C& mode_slope,
                  const Term& term,
                  const Trig& trig) {
    const C at_angle = scaled(mode, trig.value);
    sum.value[part] = sum.value[part] + at_angle * term.product;
    if constexpr (kSlopes) {
      const C by_angle = scaled(mode * term.product, trig.slope);
      sum.slope[0][part] = sum.slope[0][part] + at_angle * term.slope_in;
      sum.slope[1][part] = sum.slope[1][part] + at_angle * term.slope_out;
      sum.slope[2][part] = sum.slope[2][part] - by_angle;
      sum.slope[3][part] = sum.slope[3][part] + by_angle;
      sum.slope[4][part] = sum.slope[4][part] + scaled(mode_slope * term.product, trig.value);
    }
  }

  std::size_t orders_;
  ElevationTable table_;  // vv, hh, vh of each order
};

}  // namespace

std::unique_ptr<const CylinderSection> make_circular_section(
    double k_radius, const Complex<double>& relative_permittivity) {
  return std::make_unique<CircularSection>(k_radius, relative_permittivity);
}

}  // namespace rayloc
