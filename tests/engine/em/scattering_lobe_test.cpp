// Lobes of rough surfaces: the balance of power, the exchange of both ends, the published norms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/em/scattering_lobe.h"
#include "engine/em/slab.h"

namespace rayloc::scattering_lobe_test {
namespace {

constexpr double kPi = std::numbers::pi;

using Lobe = ScatteringLobe<double>;
using Shape = LobeShape<double>;

const Shape kLambertian{ScatteringPattern::kLambertian, 1, 1, 1};
Shape directive(double alpha) { return {ScatteringPattern::kDirective, alpha, 1, 1}; }
Shape backscattering(double alpha_r, double alpha_i, double lambda) {
  return {ScatteringPattern::kBackscattering, alpha_r, alpha_i, lambda};
}

double perfect(double /*cosine*/) { return 1.0; }
// Half space of concrete at 5 GHz.
double concrete(double cosine) {
  const auto slab = half_space_coefficients(cosine, Complex<double>{5.24, -0.58});
  return 0.5 * (abs2(slab.r_te) + abs2(slab.r_tm));
}

template <typename Reflectance>
Lobe lobe_of(const Shape& shape, const Reflectance& reflectance) {
  Lobe::AtNodes values;
  for (std::size_t i = 0; i < kLobeNodes; ++i) {
    values.at(i) = reflectance(lobe_nodes().cosine.at(i));
  }
  return {shape, values};
}

// Over the half space by the rectangle rule in angles, which shares nothing with the lobe's nodes.
template <typename Value>
double over_half_space(double cos_in, const Value& value) {
  constexpr int kZeniths = 160;
  constexpr int kAzimuths = 160;
  const double sin_in = std::sqrt(1.0 - cos_in * cos_in);
  double sum = 0.0;
  for (int i = 0; i < kZeniths; ++i) {
    const double zenith = (i + 0.5) * 0.5 * kPi / kZeniths;
    for (int j = 0; j < kAzimuths; ++j) {
      const double across = sin_in * std::sin(zenith) * std::cos((j + 0.5) * kPi / kAzimuths);
      const double along = cos_in * std::cos(zenith);
      sum += value(std::cos(zenith), along + across, along - across) * std::sin(zenith);
    }
  }
  return sum * (0.5 * kPi / kZeniths) * (2.0 * kPi / kAzimuths);
}

TEST(ScatteringLobe, ScattersThePowerMissingFromTheReflection) {
  for (const Shape& shape : {kLambertian,
                             directive(1),
                             directive(4),
                             directive(30),
                             directive(100),
                             backscattering(4, 8, 0.3),
                             backscattering(20, 50, 0.7)}) {
    for (const auto& reflectance : {perfect, concrete}) {
      const Lobe lobe = lobe_of(shape, reflectance);
      for (const double in : {0.05, 0.2, 0.5, 0.8, 0.99, 1.0}) {
        const double total = over_half_space(in, [&](double out, double reflected, double back) {
          return lobe.weight({in, reflectance(in)}, {out, reflectance(out)}, reflected, back);
        });
        EXPECT_NEAR(total / (in * reflectance(in)), 1.0, 1e-3)
            << "alpha " << shape.alpha_r << ", incidence " << in;
      }
    }
  }
}

TEST(ScatteringLobe, BothEndsMayBeExchanged) {
  const Lobe lobe = lobe_of(backscattering(4, 8, 0.3), concrete);
  const Lobe::End steep{0.9, concrete(0.9)};
  const Lobe::End flat{0.2, concrete(0.2)};
  EXPECT_DOUBLE_EQ(lobe.weight(steep, flat, 0.3, 0.1), lobe.weight(flat, steep, 0.3, 0.1));
}

TEST(ScatteringLobe, PerfectLambertianIsLambertsLaw) {
  const Lobe lobe = lobe_of(kLambertian, perfect);
  EXPECT_NEAR(lobe.weight({0.3, 1.0}, {0.8, 1.0}, 0.1, 0.2), 0.3 * 0.8 / kPi, 1e-14);
}

// Degli-Esposti 2007, (8) to (10): the integral of the directive lobe over the half space is
// F = 2^-alpha sum_j C(alpha, j) I_j with these I_j.
double published_norm(int alpha, double cos_in) {
  const double sin_in = std::sqrt(1.0 - cos_in * cos_in);
  const auto binomial = [](int n, int k) {
    return std::round(std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1)));
  };
  double sum = 0.0;
  for (int j = 0; j <= alpha; ++j) {
    double part = 1.0;
    if (j % 2 == 1) {
      part = 0.0;
      for (int w = 0; w <= (j - 1) / 2; ++w) {
        part += cos_in * binomial(2 * w, w) * std::pow(sin_in, 2 * w) / std::pow(4.0, w);
      }
    }
    sum += binomial(alpha, j) * part * 2.0 * kPi / (j + 1);
  }
  return sum / std::pow(2.0, alpha);
}

TEST(ScatteringLobe, KernelHasThePublishedNorm) {
  for (const int alpha : {1, 2, 4, 9}) {
    for (const double in : {0.1, 0.6, 1.0}) {
      const double norm = over_half_space(in, [&](double /*out*/, double reflected, double back) {
        return lobe_kernel(directive(alpha), reflected, back);
      });
      EXPECT_NEAR(norm / published_norm(alpha, in), 1.0, 3e-4) << alpha << " " << in;
    }
  }
}

}  // namespace
}  // namespace rayloc::scattering_lobe_test
