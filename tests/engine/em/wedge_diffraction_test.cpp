// Against exact solutions of the half plane and of conducting wedges.
#include "engine/em/wedge_diffraction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/em/cylinder_window.h"
#include "tests/support/exact_wedge.h"
#include "tests/support/gradient_check.h"

namespace rayloc::wedge_diffraction_test {
namespace {

using test::ExactWedge;
using test::Wall;
using Cd = std::complex<double>;

constexpr double kPi = std::numbers::pi;
constexpr double kTurn = 2.0 * kPi;  // [rad], a wavelength
constexpr std::array<Wall, 2> kWalls{Wall::kSoft, Wall::kHard};

double exterior(double interior_degrees) { return (360.0 - interior_degrees) / 180.0; }

Cd diffracted(const WedgeTerms<double>& terms, Wall wall) {
  const Complex<double> d = wall == Wall::kHard ? hard(terms) : soft(terms);
  return {d.re, d.im};
}

Cd uniform(const ExactWedge& wedge, double n, double from, double to, Wall wall) {
  return wedge.geometrical(from, to, wall) +
         diffracted(wedge_terms<double>({n, from, to, wedge.phase_length()}), wall) *
             wedge.along_the_edge();
}

// Azimuths of boundaries of light that lie outside of the wedge.
std::vector<double> boundaries(double n, double from) {
  std::vector<double> found;
  for (const double at : {from - kPi, from + kPi, kPi - from, (2.0 * n - 1.0) * kPi - from}) {
    if (at > 0.0 && at < n * kPi) {
      found.push_back(at);
    }
  }
  return found;
}

// Around the wedge, and closely around every boundary.
std::vector<double> observers(double n, double from) {
  constexpr int kRound = 40;
  std::vector<double> to;
  to.reserve(kRound);
  for (int i = 0; i < kRound; ++i) {
    to.push_back(n * kPi * (i + 0.37) / kRound);
  }
  for (const double at : boundaries(n, from)) {
    for (const double off : {1e-9, 1e-3, 0.02, 0.1}) {
      for (const double near : {at - off, at + off}) {
        if (near > 0.0 && near < n * kPi) {
          to.push_back(near);
        }
      }
    }
  }
  return to;
}

struct Worst {
  double decibels = 0.0;
  double degrees = 0.0;
  double of_incident = 0.0;
};

// Waves that cancel leave a field that any error is large beside: below -14 dB in the light the
// error is taken of the incident wave alone.
Worst worst_of(const ExactWedge& wedge, double n, double from, Wall wall) {
  constexpr double kCancelled = 0.2;
  Worst worst;
  for (const double to : observers(n, from)) {
    const double unit = std::abs(wedge.along_the_edge());
    const Cd exact = wedge.field(from, to, wall) / unit;
    const Cd found = uniform(wedge, n, from, to, wall) / unit;
    worst.of_incident = std::max(worst.of_incident, std::abs(found - exact));
    const bool lit = std::abs(wedge.geometrical(from, to, wall)) > 0.0;
    if (lit && std::abs(exact) < kCancelled) {
      continue;
    }
    worst.decibels = std::max(worst.decibels, std::abs(20.0 * std::log10(std::abs(found / exact))));
    worst.degrees = std::max(worst.degrees, std::abs(std::arg(found / exact)) * 180.0 / kPi);
  }
  return worst;
}

Worst worst_of(const ExactWedge& wedge, double n) {
  Worst worst;
  for (const double share : {0.02, 0.16, 0.31, 0.5, 0.73, 0.97}) {
    for (const Wall wall : kWalls) {
      const Worst one = worst_of(wedge, n, share * n * kPi, wall);
      worst = {std::max(worst.decibels, one.decibels),
               std::max(worst.degrees, one.degrees),
               std::max(worst.of_incident, one.of_incident)};
    }
  }
  return worst;
}

// For the tables of engine/studies/2026-11-diffraction.md: --gtest_output=xml.
void record(const std::string& wave, double wavelengths, const Worst& worst) {
  ::testing::Test::RecordProperty(wave + " " + std::to_string(wavelengths),
                                  std::to_string(worst.decibels) + " dB, " +
                                      std::to_string(worst.degrees) + " degrees, " +
                                      std::to_string(worst.of_incident));
}

// Sommerfeld's solution: each wave is that of a knife edge.
Cd half_plane(double kr, double from, double to, Wall wall) {
  const auto wave = [&](double angle) {
    const double u = std::sqrt(4.0 * kr / kPi) * std::cos(angle / 2.0);
    const Complex<double> lit = knife_edge(u);
    return std::polar(1.0, kr * std::cos(angle)) * Cd{lit.re, lit.im};
  };
  return wave(to - from) + (wall == Wall::kHard ? 1.0 : -1.0) * wave(to + from);
}

TEST(WedgeDiffraction, IsExactForAHalfPlane) {
  for (const double wavelengths : {0.5, 2.0, 50.0}) {
    const ExactWedge wedge(2.0, kTurn * wavelengths);
    for (const double from : {0.3, 1.7, 4.0}) {
      for (const double to : observers(2.0, from)) {
        for (const Wall wall : kWalls) {
          const Cd exact = half_plane(kTurn * wavelengths, from, to, wall);
          EXPECT_NEAR(std::abs(uniform(wedge, 2.0, from, to, wall) - exact), 0.0, 1e-10);
          EXPECT_NEAR(std::abs(wedge.field(from, to, wall) - exact), 0.0, 1e-10);
        }
      }
    }
  }
}

class WedgeAngle : public ::testing::TestWithParam<double> {};

TEST_P(WedgeAngle, PlaneWaveMatchesTheEigenfunctions) {
  const double n = exterior(GetParam());
  for (const double wavelengths : {0.5, 1.0, 2.0, 5.0, 50.0}) {
    const Worst worst = worst_of(ExactWedge(n, kTurn * wavelengths), n);
    const bool is_far = wavelengths >= 2.0;
    EXPECT_LE(worst.decibels, is_far ? 0.3 : 1.0) << wavelengths;
    EXPECT_LE(worst.degrees, is_far ? 3.0 : 10.0) << wavelengths;
    EXPECT_LE(worst.of_incident, is_far ? 0.015 : 0.06) << wavelengths;
    record("plane wave", wavelengths, worst);
  }
}

TEST_P(WedgeAngle, LineSourceMatchesTheEigenfunctions) {
  const double n = exterior(GetParam());
  for (const double wavelengths : {0.5, 2.0, 10.0}) {
    const Worst worst = worst_of(ExactWedge(n, kTurn * wavelengths, 3.0 * kTurn * wavelengths), n);
    const bool is_far = wavelengths >= 2.0;
    EXPECT_LE(worst.decibels, is_far ? 0.3 : 1.0) << wavelengths;
    EXPECT_LE(worst.degrees, is_far ? 3.0 : 10.0) << wavelengths;
    record("line source", wavelengths, worst);
  }
}

TEST_P(WedgeAngle, SlopeMatchesTheSlopeOfTheEigenfunctions) {
  const double n = exterior(GetParam());
  for (const double wavelengths : {2.0, 10.0}) {
    const double kr = kTurn * wavelengths;
    const ExactWedge wedge(n, kr);
    for (const double share : {0.16, 0.5, 0.73}) {
      const double from = share * n * kPi;
      for (const double to : observers(n, from)) {
        for (const Wall wall : kWalls) {
          const Cd found = wedge.geometrical(from, to, wall, true) +
                           diffracted(wedge_slope_terms<double>({n, from, to, kr}), wall) *
                               wedge.along_the_edge();
          // Beside the slope of the incident wave.
          EXPECT_NEAR(std::abs(found - wedge.field(from, to, wall, true)) / kr, 0.0, 0.01)
              << wavelengths << " " << from << " " << to;
        }
      }
    }
  }
}

TEST_P(WedgeAngle, FieldIsContinuousAcrossBoundaries) {
  const double n = exterior(GetParam());
  const ExactWedge wedge(n, kTurn * 3.0, kTurn * 7.0);
  for (const double share : {0.16, 0.5, 0.73}) {
    const double from = share * n * kPi;
    for (const double at : boundaries(n, from)) {
      for (const Wall wall : kWalls) {
        constexpr double kOff = 1e-10;
        EXPECT_NEAR(std::abs(uniform(wedge, n, from, at - kOff, wall) -
                             uniform(wedge, n, from, at + kOff, wall)),
                    0.0,
                    1e-8);
      }
    }
  }
}

TEST_P(WedgeAngle, EndsMayBeExchanged) {
  const double n = exterior(GetParam());
  const auto there = wedge_terms<double>({n, 0.2 * n * kPi, 0.7 * n * kPi, 30.0});
  const auto back = wedge_terms<double>({n, 0.7 * n * kPi, 0.2 * n * kPi, 30.0});
  for (const Wall wall : kWalls) {
    EXPECT_NEAR(std::abs(diffracted(there, wall) - diffracted(back, wall)), 0.0, 1e-14);
  }
}

TEST_P(WedgeAngle, DerivativesMatchCentralDifferences) {
  const double n = exterior(GetParam());
  for (const double from : {0.16 * n * kPi, 0.6 * n * kPi}) {
    std::vector<double> to{0.05 * n * kPi, 0.43 * n * kPi, 0.93 * n * kPi};
    for (const double at : boundaries(n, from)) {
      to.insert(to.end(), {at - 1e-4, at + 1e-4});
    }
    for (const double azimuth : to) {
      for (int part = 0; part < 8; ++part) {
        const auto f = [&](const auto& x) {
          using T = std::decay_t<decltype(x[0])>;
          const WedgeRay<T> ray{n, x[0], x[1], x[2]};
          const WedgeTerms<T> terms = part < 4 ? wedge_terms(ray) : wedge_slope_terms(ray);
          const Complex<T> field = part % 4 < 2 ? soft(terms) : hard(terms);
          return part % 2 == 0 ? field.re : field.im;
        };
        test::expect_gradient_matches<3>(f, {from, azimuth, 40.0});
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Interior,
    WedgeAngle,
    ::testing::Values(
        0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 200.0, 225.0, 240.0, 255.0, 270.0, 300.0));

TEST(WedgeTransition, FarAwayIsTheSeriesAndCloseTheIntegral) {
  // Both sides of the change between the two.
  const WedgeTransition<double> below = wedge_transition(6.0 - 1e-9);
  const WedgeTransition<double> above = wedge_transition(6.0 + 1e-9);
  EXPECT_NEAR(below.value.re, above.value.re, 1e-9);
  EXPECT_NEAR(below.value.im, above.value.im, 1e-9);
  EXPECT_NEAR(below.excess.re, above.excess.re, 1e-9);
  EXPECT_NEAR(below.excess.im, above.excess.im, 1e-9);
}

TEST(WedgeTransition, AtABoundaryIsHalfOfAWave) {
  // sqrt(pi) exp(j pi / 4)
  const WedgeTransition<double> at = wedge_transition(0.0);
  EXPECT_NEAR(at.value.re, std::sqrt(kPi / 2.0), 1e-14);
  EXPECT_NEAR(at.value.im, std::sqrt(kPi / 2.0), 1e-14);
  EXPECT_EQ(at.excess.re, -1.0);
}

}  // namespace
}  // namespace rayloc::wedge_diffraction_test
