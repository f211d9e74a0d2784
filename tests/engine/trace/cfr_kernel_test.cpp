#include "engine/trace/cfr_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <hwy/highway.h>

#include "tests/support/path_columns.h"

namespace rayloc::cfr_kernel_test {
namespace {

using Complex64 = std::complex<double>;
using ComplexL = std::complex<long double>;
using test::PathColumns;

// Delays to 1 us, magnitudes over four decades.
PathColumns random_paths(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> delay(0.0, 1e-6);
  std::uniform_real_distribution<double> decades(-4.0, 0.0);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  PathColumns paths;
  for (std::size_t p = 0; p < size; ++p) {
    // Drawn one by one: the order in which arguments are evaluated differs between compilers.
    const double phase = angle(random);
    const double magnitude = std::pow(10.0, decades(random));
    paths.add(std::polar(magnitude, phase), delay(random));
  }
  return paths;
}

std::vector<Complex64> random_tones(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Complex64> tones(size);
  for (Complex64& tone : tones) {
    tone = {normal(random), normal(random)};
  }
  return tones;
}

OfdmGrid grid_from_to(int first, int last, double spacing_hz = 312'500.0) {
  OfdmGrid grid{5.25e9, spacing_hz, {}};
  for (int k = first; k <= last; ++k) {
    grid.tone_index.push_back(static_cast<std::int16_t>(k));
  }
  return grid;
}

// 80 MHz without its edges, the three tones around 0 and some others.
OfdmGrid grid_with_gaps() {
  OfdmGrid grid = grid_from_to(-122, 122);
  std::erase_if(grid.tone_index, [](int k) {
    return std::abs(k) < 2 || k == 17 || (k > 60 && k < 95) || (k > 100 && k % 7 == 0);
  });
  return grid;
}

long double wide(double value) { return static_cast<long double>(value); }

// The definition, in extended precision.
std::vector<ComplexL> direct_sum(const PathColumns& paths, const OfdmGrid& grid) {
  std::vector<ComplexL> h(grid.size());
  for (std::size_t j = 0; j < grid.size(); ++j) {
    const long double frequency_hz =
        wide(grid.centre_hz) + wide(grid.spacing_hz) * grid.tone_index[j];
    for (std::size_t p = 0; p < paths.size(); ++p) {
      const long double angle =
          -2.0L * std::numbers::pi_v<long double> * frequency_hz * wide(paths.tau[p]);
      h[j] += ComplexL(wide(paths.a_re[p]), wide(paths.a_im[p])) * std::polar(1.0L, angle);
    }
  }
  return h;
}

std::vector<Complex64> forward(const PathColumns& paths, const OfdmGrid& grid) {
  std::vector<Complex64> h(grid.size(), {std::nan(""), 0.0});
  CfrKernel(grid).forward(paths.arrays(), h);
  return h;
}

// Largest |h - reference| over the largest |reference|.
template <typename T>
double relative_error(const std::vector<Complex64>& h, const std::vector<T>& reference) {
  long double error = 0.0L;
  long double largest = 0.0L;
  for (std::size_t j = 0; j < reference.size(); ++j) {
    error = std::max(error, std::abs(ComplexL(h[j]) - ComplexL(reference[j])));
    largest = std::max(largest, std::abs(ComplexL(reference[j])));
  }
  return static_cast<double>(error / largest);
}

TEST(CfrKernel, MatchesTheDefinition) {
  for (const std::size_t num_paths : {1U, 2U, 3U, 7U, 16U, 150U, 151U}) {
    const PathColumns paths = random_paths(num_paths, 1);
    for (const OfdmGrid& grid : {grid_from_to(-64, 63),
                                 grid_from_to(5, 5),
                                 grid_from_to(-3, 13),
                                 grid_from_to(-3, 12),
                                 grid_with_gaps()}) {
      EXPECT_LT(relative_error(forward(paths, grid), direct_sum(paths, grid)), 5e-12)
          << num_paths << " paths, " << grid.size() << " tones";
    }
  }
}

TEST(CfrKernel, MatchesTheDefinitionOn160MHzWith2000PathsAnd2000Tones) {
  const PathColumns paths = random_paths(2000, 2);
  const OfdmGrid grid = grid_from_to(-1000, 999, 78'125.0);
  EXPECT_LT(relative_error(forward(paths, grid), direct_sum(paths, grid)), 5e-12);
}

TEST(CfrKernel, TonesFarApartAreAllowed) {
  const PathColumns paths = random_paths(40, 3);
  OfdmGrid every_fourth{5.25e9, 312'500.0, {}};
  for (int k = -122; k <= 122; k += 4) {
    every_fourth.tone_index.push_back(static_cast<std::int16_t>(k));
  }
  const OfdmGrid scattered{5.25e9, 78'125.0, {-32768, -32767, -9001, 0, 1, 2, 300, 32767}};
  for (const OfdmGrid& grid : {every_fourth, scattered}) {
    EXPECT_LT(relative_error(forward(paths, grid), direct_sum(paths, grid)), 5e-12);
  }
}

TEST(CfrKernel, NoPathsOrTonesGiveZeroOrEmptyResults) {
  EXPECT_EQ(forward({}, grid_from_to(-1, 1)), std::vector<Complex64>(3));
  EXPECT_TRUE(forward(random_paths(3, 4), {5.25e9, 312'500.0, {}}).empty());
  const CfrKernel kernel(grid_from_to(-1, 1));
  EXPECT_TRUE(kernel.adjoint({}, std::vector<Complex64>(3)).tau.empty());
  const PathColumns paths = random_paths(3, 4);
  const PathAdjoints silent = CfrKernel({5.25e9, 312'500.0, {}}).adjoint(paths.arrays(), {});
  EXPECT_EQ(silent.tau, std::vector<double>(3, 0.0));
}

// Re sum conj(g) h, the loss whose derivative by h is g.
double loss(const PathColumns& paths, const OfdmGrid& grid, const std::vector<Complex64>& g) {
  const std::vector<Complex64> h = forward(paths, grid);
  double sum = 0.0;
  for (std::size_t j = 0; j < h.size(); ++j) {
    sum += (std::conj(g[j]) * h[j]).real();
  }
  return sum;
}

// h is linear in a, so that Re sum conj(g) h = Re sum conj(a~) a.
TEST(CfrKernelAdjoint, IsTheTransposeOfForward) {
  for (const OfdmGrid& grid : {grid_with_gaps(), grid_from_to(-1000, 999, 78'125.0)}) {
    for (const std::size_t num_paths : {1U, 9U, 333U}) {
      const PathColumns paths = random_paths(num_paths, 5);
      const std::vector<Complex64> g = random_tones(grid.size(), 6);
      const PathAdjoints adjoint = CfrKernel(grid).adjoint(paths.arrays(), g);
      double sum = 0.0;
      for (std::size_t p = 0; p < num_paths; ++p) {
        sum += adjoint.a_re[p] * paths.a_re[p] + adjoint.a_im[p] * paths.a_im[p];
      }
      const double expected = loss(paths, grid, g);
      EXPECT_NEAR(sum, expected, 1e-10 * static_cast<double>(grid.size()));
      EXPECT_GT(std::abs(expected), 1e-3);
    }
  }
}

TEST(CfrKernelAdjoint, MatchesItsDefinition) {
  const OfdmGrid grid = grid_with_gaps();
  const PathColumns paths = random_paths(37, 7);
  const std::vector<Complex64> g = random_tones(grid.size(), 8);
  const PathAdjoints adjoint = CfrKernel(grid).adjoint(paths.arrays(), g);
  const long double turn = 2.0L * std::numbers::pi_v<long double>;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    ComplexL s0;
    ComplexL s1;
    for (std::size_t j = 0; j < grid.size(); ++j) {
      const long double frequency_hz =
          wide(grid.centre_hz) + wide(grid.spacing_hz) * grid.tone_index[j];
      const ComplexL term =
          std::conj(ComplexL(g[j])) * std::polar(1.0L, -turn * frequency_hz * wide(paths.tau[p]));
      s0 += term;
      s1 += frequency_hz * term;
    }
    const ComplexL a(wide(paths.a_re[p]), wide(paths.a_im[p]));
    const auto by_tau = static_cast<double>(turn * (a * s1).imag());
    EXPECT_NEAR(adjoint.a_re[p], static_cast<double>(s0.real()), 1e-9) << p;
    EXPECT_NEAR(adjoint.a_im[p], static_cast<double>(-s0.imag()), 1e-9) << p;
    EXPECT_NEAR(adjoint.tau[p], by_tau, 1e-9 * static_cast<double>(std::abs(turn * a * s1))) << p;
  }
}

TEST(CfrKernelAdjoint, MatchesCentralDifferences) {
  const OfdmGrid grid = grid_with_gaps();
  const PathColumns paths = random_paths(11, 9);
  const std::vector<Complex64> g = random_tones(grid.size(), 10);
  const PathAdjoints adjoint = CfrKernel(grid).adjoint(paths.arrays(), g);
  const auto difference =
      [&](std::vector<double> PathColumns::*column, std::size_t p, double step) {
        PathColumns more = paths;
        PathColumns less = paths;
        (more.*column)[p] += step;
        (less.*column)[p] -= step;
        return (loss(more, grid, g) - loss(less, grid, g)) / (2.0 * step);
      };
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const double magnitude = std::hypot(adjoint.a_re[p], adjoint.a_im[p]);
    EXPECT_NEAR(adjoint.a_re[p], difference(&PathColumns::a_re, p, 1e-3), 1e-6 * magnitude);
    EXPECT_NEAR(adjoint.a_im[p], difference(&PathColumns::a_im, p, 1e-3), 1e-6 * magnitude);
    // 1 fs is a 30 000th of a turn of the carrier. 2 pi |a| |S0| f is the scale of the slope.
    const double slope =
        2.0 * std::numbers::pi * 5.25e9 * magnitude * std::hypot(paths.a_re[p], paths.a_im[p]);
    EXPECT_NEAR(adjoint.tau[p], difference(&PathColumns::tau, p, 1e-15), 1e-6 * slope);
  }
}

// Every kind of processor whose code runs on this one.
class CfrKernelTargets : public ::testing::Test {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(CfrKernelTargets, AgreeWithin1e12) {
  const OfdmGrid grid = grid_from_to(-1000, 999, 78'125.0);
  const PathColumns paths = random_paths(301, 11);
  const std::vector<Complex64> g = random_tones(grid.size(), 12);
  const CfrKernel kernel(grid);
  const std::vector<Complex64> h = forward(paths, grid);
  const PathAdjoints adjoint = kernel.adjoint(paths.arrays(), g);
  const auto expect_near = [](const std::vector<double>& x, const std::vector<double>& y) {
    const double largest = std::abs(*std::max_element(
        x.begin(), x.end(), [](double l, double r) { return std::abs(l) < std::abs(r); }));
    for (std::size_t p = 0; p < x.size(); ++p) {
      EXPECT_NEAR(x[p], y[p], 1e-12 * largest) << p;
    }
  };
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), 2U);
  for (const std::int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_LT(relative_error(forward(paths, grid), h), 1e-12);
    const PathAdjoints other = kernel.adjoint(paths.arrays(), g);
    expect_near(adjoint.a_re, other.a_re);
    expect_near(adjoint.a_im, other.a_im);
    expect_near(adjoint.tau, other.tau);
  }
}

}  // namespace
}  // namespace rayloc::cfr_kernel_test
