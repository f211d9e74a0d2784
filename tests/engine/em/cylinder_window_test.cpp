#include "engine/em/cylinder_window.h"

#include <gtest/gtest.h>

#include <array>

namespace rayloc::cylinder_window_test {
namespace {

TEST(KnifeEdge, MatchesTabulatedFresnelIntegrals) {
  struct Row {
    double u, re, im;
  };
  // 0.5 + (1 + j) / 2 (C(u) - j S(u)) with scipy.special.fresnel (1.10.1).
  constexpr std::array<Row, 7> kRows{{{-5.0, -0.0314112853106, -0.0322199033934},
                                      {-2.41, -0.0842752221576, 0.0387416530377},
                                      {-2.39, -0.0898870998579, 0.0257752301468},
                                      {0.3, 0.6567589870293, 0.1426419890227},
                                      {1.0, 1.1090762738836, 0.1708171264932},
                                      {2.39, 1.0898870998579, -0.0257752301468},
                                      {8.0, 0.9800081973851, 0.0197939829921}}};
  for (const Row& row : kRows) {
    const Complex<double> value = knife_edge(row.u);
    EXPECT_NEAR(value.re, row.re, 1e-12) << row.u;
    EXPECT_NEAR(value.im, row.im, 1e-12) << row.u;
  }
}

TEST(KnifeEdge, SlopeMatchesCentralDifferences) {
  constexpr double kStep = 1e-5;
  for (const double u : {-3.0, -0.5, 0.0, 1.7, 2.4, 4.0}) {
    const Complex<double> slope = knife_edge_slope(u);
    const Complex<double> high = knife_edge(u + kStep);
    const Complex<double> low = knife_edge(u - kStep);
    EXPECT_NEAR(slope.re, (high.re - low.re) / (2.0 * kStep), 1e-8) << u;
    EXPECT_NEAR(slope.im, (high.im - low.im) / (2.0 * kStep), 1e-8) << u;
  }
}

}  // namespace
}  // namespace rayloc::cylinder_window_test
