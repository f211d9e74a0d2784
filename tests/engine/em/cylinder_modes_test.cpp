// Against tests/data/goldens/cylinder (SciPy), and against physics.
#include "engine/em/cylinder_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "engine/em/cylinder_bessel.h"
#include "engine/em/radio_material.h"
#include "tests/support/golden.h"

namespace rayloc::cylinder_modes_test {
namespace {

using nlohmann::json;

double degrees(double angle) { return angle * std::numbers::pi / 180.0; }
std::complex<double> value(const Complex<double>& z) { return {z.re, z.im}; }

TEST(CylinderModes, MatchTheSolutionOfTheBoundaryConditions) {
  const json doc = test::golden("cylinder/oblique_modes");
  double worst = 0.0;
  for (const json& c : doc.at("cases")) {
    const double k_radius = c.at("k_radius");
    const double elevation = degrees(c.at("elevation"));
    const CylinderModes modes = circular_modes(
        k_radius,
        complex_permittivity({"body", c.at("eps_r"), c.at("sigma")}, doc.at("frequency")),
        std::cos(elevation),
        cylinder_order_count(k_radius));
    for (const json& row : c.at("rows")) {
      const std::size_t n = row.at(0);
      const auto expected = [&](std::size_t i) {
        return std::complex<double>(row.at(2 * i + 1), row.at(2 * i + 2));
      };
      const std::complex<double> cross = std::sin(elevation) * value(modes.cross[n]);
      worst = std::max({worst,
                        std::abs(value(modes.vv[n]) - expected(0)),
                        std::abs(value(modes.hh[n]) - expected(1)),
                        std::abs(cross - expected(2)),
                        std::abs(-cross - expected(3))});
    }
  }
  EXPECT_LT(worst, 1e-10);  // as many digits as the file has
}

TEST(CylinderModes, ConserveEnergyWithoutLoss) {
  for (const double cos_elevation : {1.0, 0.8, 0.3}) {
    const CylinderModes modes = circular_modes(20.0, {3.7, 0.0}, cos_elevation, 40);
    const double sin = std::sqrt(1.0 - cos_elevation * cos_elevation);
    for (std::size_t n = 0; n < 40; ++n) {
      const std::complex<double> vv = 1.0 + 2.0 * value(modes.vv[n]);
      const std::complex<double> hh = 1.0 + 2.0 * value(modes.hh[n]);
      const std::complex<double> cross = 2.0 * sin * value(modes.cross[n]);
      EXPECT_NEAR(std::norm(vv) + std::norm(cross), 1.0, 1e-11) << n;
      EXPECT_NEAR(std::norm(hh) + std::norm(cross), 1.0, 1e-11) << n;
      EXPECT_NEAR(std::abs(vv * std::conj(cross) - cross * std::conj(hh)), 0.0, 1e-11) << n;
    }
  }
}

TEST(CylinderModes, AbsorbWithLoss) {
  const CylinderModes modes = circular_modes(20.0, {36.0, -13.9}, 0.9, 25);
  for (std::size_t n = 0; n < 15; ++n) {
    EXPECT_LT(std::norm(1.0 + 2.0 * value(modes.vv[n])), 0.99);
    EXPECT_LT(std::norm(1.0 + 2.0 * value(modes.hh[n])), 0.99);
  }
}

TEST(CylinderModes, MatchAPerfectConductorForAGoodOne) {
  const double x = 12.0;
  const CylinderModes modes = circular_modes(x, {1.0, -3.5e7}, 1.0, 20);
  std::vector<Complex<double>> h(21);
  hankel_orders(x, h);
  for (std::size_t n = 0; n < 20; ++n) {
    const std::complex<double> hn = value(h[n]);
    const std::complex<double> slope = static_cast<double>(n) / x * hn - value(h[n + 1]);
    EXPECT_NEAR(std::abs(value(modes.vv[n]) + hn.real() / hn), 0.0, 1e-3);
    EXPECT_NEAR(std::abs(value(modes.hh[n]) + slope.real() / slope), 0.0, 1e-3);
  }
}

TEST(CylinderModes, VanishWithTheRadius) {
  const CylinderModes modes = circular_modes(1e-3, {36.0, -13.9}, 1.0, 12);
  for (std::size_t n = 0; n < 12; ++n) {
    EXPECT_LT(std::abs(value(modes.vv[n])), 1e-4);
    EXPECT_LT(std::abs(value(modes.hh[n])), 1e-4);
  }
}

}  // namespace
}  // namespace rayloc::cylinder_modes_test
