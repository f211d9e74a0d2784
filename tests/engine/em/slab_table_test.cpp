#include "engine/em/slab_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/em/slab.h"

namespace rayloc::slab_table_test {
namespace {

constexpr double kWavelength = 0.0579;  // [m], 5.18 GHz

struct Material {
  Complex<double> permittivity;
  double thickness;
};
const std::vector<Material> kMaterials{{{5.24, -0.58}, 0.1},
                                       {{5.24, -0.58}, 0.3},
                                       {{6.31, 0.0}, 0.01},  // lossless
                                       {{2.73, -0.14}, 0.0125},
                                       {{1.0, -3.47e7}, 0.1},  // metal
                                       {{5.24, -0.58}, std::numeric_limits<double>::infinity()}};

SlabCoefficients<double> exact(const Material& m, double cos_theta) {
  return std::isinf(m.thickness)
             ? half_space_coefficients(cos_theta, m.permittivity)
             : slab_coefficients(cos_theta, m.permittivity, m.thickness, kWavelength);
}

void expect_near(const Complex<double>& a, const Complex<double>& b, double tolerance) {
  EXPECT_NEAR(a.re, b.re, tolerance);
  EXPECT_NEAR(a.im, b.im, tolerance);
}

TEST(SlabTable, AgreesWithTheFormulas) {
  for (const Material& m : kMaterials) {
    const SlabTable table(m.permittivity, m.thickness, kWavelength);
    ASSERT_TRUE(table.covers(0.05)) << m.permittivity.re;
    for (int i = 0; i <= 4000; ++i) {
      const double c = std::min(1.0, 0.05 + 0.95 * i / 4000.0);
      const auto s = exact(m, c);
      const auto r = table.reflection(c);
      const auto t = table.transmission(c);
      const double excess = std::max(1.0, std::sqrt(abs2(s.r_excess)));
      expect_near(r.te, s.r_te, 1e-12);
      expect_near(r.excess, s.r_excess, 1e-12 * excess);
      expect_near(t.te, s.t_te, 1e-12);
      expect_near(t.excess, s.t_excess, 1e-12 * excess);
    }
  }
}

TEST(SlabTable, SlopeIsThatOfTheFormulas) {
  using Dual = ceres::Jet<double, 1>;
  for (const Material& m : kMaterials) {
    const SlabTable table(m.permittivity, m.thickness, kWavelength);
    for (const double c : {0.06, 0.2, 0.5, 0.77, 1.0}) {
      const Dual x(c, 0);
      const Complex<Dual> permittivity{Dual(m.permittivity.re), Dual(m.permittivity.im)};
      const auto s = std::isinf(m.thickness)
                         ? half_space_coefficients(x, permittivity)
                         : slab_coefficients(x, permittivity, Dual(m.thickness), Dual(kWavelength));
      const auto r = table.reflection(x);
      const double scale = std::max(1.0, std::abs(s.r_excess.re.v[0]) + std::abs(s.r_te.re.v[0]));
      EXPECT_NEAR(r.te.re.v[0], s.r_te.re.v[0], 1e-9 * scale);
      EXPECT_NEAR(r.te.im.v[0], s.r_te.im.v[0], 1e-9 * scale);
      EXPECT_NEAR(r.excess.re.v[0], s.r_excess.re.v[0], 1e-9 * scale);
      EXPECT_NEAR(r.excess.im.v[0], s.r_excess.im.v[0], 1e-9 * scale);
    }
  }
}

TEST(SlabTable, LeavesGrazingIncidenceToTheFormulas) {
  const SlabTable table({5.24, -0.58}, 0.1, kWavelength);
  EXPECT_FALSE(table.covers(0.049));
  EXPECT_TRUE(table.covers(1.0));
  EXPECT_FALSE(SlabTable().covers(1.0));
}

}  // namespace
}  // namespace rayloc::slab_table_test
