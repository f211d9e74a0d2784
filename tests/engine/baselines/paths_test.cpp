// The blocks that methods of bearings and delays share, against what was written down for them:
// analytic arrays, formulas, and numbers of other programs.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/baselines/paths/bearing.h"
#include "engine/baselines/paths/gaussian_mixture.h"
#include "engine/baselines/paths/music.h"
#include "engine/baselines/paths/path_count.h"
#include "engine/baselines/paths/path_loss_law.h"
#include "engine/baselines/paths/phase_errors.h"
#include "engine/baselines/paths/sanitise.h"
#include "engine/baselines/paths/smoothed_csi.h"
#include "engine/baselines/paths/tone_comb.h"
#include "engine/baselines/paths/turn.h"
#include "engine/channel/tone_plan.h"
#include "tests/engine/baselines/two_paths.h"

namespace rayloc::paths_test {
namespace {

using ::testing::ElementsAre;

constexpr double kStep = 1.25e6;  // [Hz], of the comb at 40 MHz
constexpr double kPi = std::numbers::pi;

std::vector<int> comb_of(PhyFormat phy, int bandwidth) {
  const TonePlan& plan = tone_plan(phy, bandwidth);
  const OfdmGrid grid{5.19e9, plan.spacing_hz, plan.active};
  std::vector<int> tones;
  for (const std::size_t k : tone_comb(grid).tone) {
    tones.push_back(grid.tone_index[k]);
  }
  return tones;
}

TEST(ToneComb, IsInEqualStepsAboutTheCentreOfEveryBandwidth) {
  struct Case {
    int bandwidth;
    int step;
    std::size_t count;
  };
  // At 40 MHz the 30 tones of the Intel 5300.
  for (const Case& one : {Case{20, 2, 28}, Case{40, 4, 30}, Case{80, 8, 30}, Case{160, 16, 32}}) {
    const auto tones = comb_of(PhyFormat::kVht, one.bandwidth);
    ASSERT_EQ(tones.size(), one.count) << one.bandwidth;
    for (std::size_t i = 0; i < tones.size(); ++i) {
      EXPECT_EQ(tones[i],
                one.step * (2 * static_cast<int>(i) + 1 - static_cast<int>(one.count)) / 2);
    }
  }
  EXPECT_EQ(comb_of(PhyFormat::kVht, 40).front(), -58);
}

TEST(ToneComb, IsEmptyWhereThereIsNone) {
  EXPECT_TRUE(tone_comb({5.19e9, 312'500.0, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}}).tone.empty());
}

constexpr std::array kTwoWaves = {test::PlaneWave{0.9, 5e-9, 1.0},
                                  test::PlaneWave{-1.6, 30e-9, {0.32, 0.5}}};

TEST(Sanitise, DoesNotSeeTheOffsetsOfAFrame) {
  const Eigen::MatrixXcd h = test::array_of(kTwoWaves, kStep, 30.0);
  const Eigen::MatrixXcd first = sanitised(h);
  for (const auto& [phase, delay] : {std::pair{1.0, 60e-9}, {-2.0, 350e-9}, {3.0, 550e-9}}) {
    Eigen::MatrixXcd other = h;
    for (Eigen::Index k = 0; k < h.cols(); ++k) {
      other.col(k) *= turn(phase - 2.0 * kPi * delay * kStep * static_cast<double>(k));
    }
    EXPECT_LT((sanitised(other) - first).cwiseAbs().maxCoeff(), 1e-9) << delay;
  }
}

TEST(Sanitise, KeepsPhasesBetweenAntennasAndAmplitudes) {
  const Eigen::MatrixXcd h = test::array_of(kTwoWaves, kStep, 30.0);
  const Eigen::MatrixXcd flat = sanitised(h);
  for (Eigen::Index k = 0; k < h.cols(); ++k) {
    EXPECT_NEAR(
        std::abs(flat(1, k) * std::conj(flat(0, k)) - h(1, k) * std::conj(h(0, k))), 0.0, 1e-12);
  }
}

TEST(SmoothedCsi, IsThirtyByThirtyTwoAndEveryColumnAWindow) {
  const Eigen::MatrixXcd h = test::array_of(kTwoWaves, kStep, 30.0);
  const SmoothingWindow window = smoothing_window(h);
  const Eigen::MatrixXcd x = smoothed_csi(h, window);
  ASSERT_EQ(x.rows(), 30);
  ASSERT_EQ(x.cols(), 32);
  EXPECT_EQ(x(0, 0), h(0, 0));
  EXPECT_EQ(x(15, 0), h(1, 0));    // the second antenna of the first window
  EXPECT_EQ(x(14, 15), h(0, 29));  // the last tone of its last place
  EXPECT_EQ(x(15 + 3, 16 + 2), h(2, 5));
}

TEST(PathCount, EndsAtTheLastLargeDrop) {
  EXPECT_EQ(count_paths(std::array{100.0, 90.0, 40.0, 2.0, 1.9, 1.8}, 32), 3U);
  EXPECT_EQ(count_paths(std::array{100.0, 4.0, 0.1, 0.09, 0.08, 0.07}, 32), 2U);
  EXPECT_EQ(count_paths(std::array{100.0, 0.1, 0.1, 0.1, 0.1, 0.1}, 32), kFewestPaths);
  EXPECT_EQ(count_paths(std::array{100.0, 90.0, 80.0, 70.0, 65.0, 60.0}, 32), 3U)
      << "no drop is large: the largest counts";
}

TEST(PathCount, MatchesTheMinimumDescriptionLengthFormula) {
  // The formula in numpy for these eigenvalues and 32 snapshots has its least value, 49.85, at 2.
  const std::array e = {10.0, 4.0, 0.02, 0.018, 0.017, 0.016, 0.015, 0.014};
  EXPECT_EQ(count_paths(e, 32, PathCountRule::kMdl), 2U);
  const std::array more = {10.0, 4.0, 3.0, 1.0, 0.017, 0.016, 0.015, 0.014};
  EXPECT_EQ(count_paths(more, 32, PathCountRule::kMdl), 4U);
}

// At half a wavelength nearly, and at the spacing of an RT-AX86U.
TEST(Music, FindsTwoPathsOfAnAnalyticArray) {
  for (const double spacing : {0.45, 1.54}) {
    const auto psi = [&](double degrees) {
      return wrapped(2.0 * kPi * spacing * std::sin(degrees / 180.0 * kPi));
    };
    const std::array waves = {test::PlaneWave{psi(20.0), 5e-9, 1.0},
                              test::PlaneWave{psi(-35.0), 30e-9, std::polar(0.6, 1.0)}};
    const Eigen::MatrixXcd h = test::array_of(waves, kStep, 80.0);
    const Music music(smoothing_window(h), kStep);
    auto paths = music.paths(h);
    ASSERT_EQ(paths.size(), 2U) << spacing;
    std::sort(
        paths.begin(), paths.end(), [](const auto& a, const auto& b) { return a.tau < b.tau; });
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(wrapped(paths[i].psi - waves[i].psi), 0.0, 0.01) << spacing;
      EXPECT_NEAR(paths[i].tau, waves[i].tau, 0.5e-9) << spacing;
      EXPECT_GT(paths[i].score, 0.999);
    }
    auto relative = music.paths(sanitised(h));
    ASSERT_EQ(relative.size(), 2U);
    EXPECT_NEAR(std::abs(relative[1].tau - relative[0].tau), 25e-9, 0.5e-9) << spacing;
  }
}

TEST(Music, ResolvesFivePaths) {
  std::vector<test::PlaneWave> waves;
  for (int i = 0; i < 5; ++i) {
    waves.push_back(
        {-2.5 + 1.2 * i, (10.0 + 17.0 * ((3 * i) % 5)) * 1e-9, std::polar(1.0, 1.3 * i)});
  }
  const Eigen::MatrixXcd h = test::array_of(waves, kStep, 90.0);
  MusicOptions options;
  options.count = PathCountRule::kMdl;
  const auto paths = Music(smoothing_window(h), kStep, options).paths(h);
  ASSERT_EQ(paths.size(), 5U);
  for (const test::PlaneWave& wave : waves) {
    EXPECT_TRUE(std::any_of(paths.begin(),
                            paths.end(),
                            [&](const PathAtArray& path) {
                              return std::abs(wrapped(path.psi - wave.psi)) < 0.01 &&
                                     std::abs(path.tau - wave.tau) < 0.5e-9;
                            }))
        << wave.psi << " " << wave.tau;
  }
}

TEST(Music, WorksWithTwoAntennas) {
  const std::array waves = {test::PlaneWave{0.9, 5e-9, 1.0},
                            test::PlaneWave{-1.6, 30e-9, std::polar(0.6, 1.0)}};
  const Eigen::MatrixXcd h = test::array_of(waves, kStep, 80.0, 2);
  const auto paths = Music(smoothing_window(h), kStep).paths(h);
  ASSERT_EQ(paths.size(), 2U);
  EXPECT_NEAR(paths[0].psi, 0.9, 0.01);
  EXPECT_NEAR(paths[1].psi, -1.6, 0.01);
}

TEST(GaussianMixture, OneComponentHasTheMeanAndVariance) {
  Eigen::MatrixXd points(2, 5);
  points << 1, 2, 3, 4, 10, 0, 1, 0, 1, 3;
  MixtureOptions options;
  options.components = 1;
  options.least_variance = 0.0;
  const auto mixture = fit_mixture(points, options);
  ASSERT_EQ(mixture.components.size(), 1U);
  EXPECT_NEAR(mixture.components[0].mean(0), 4.0, 1e-12);
  EXPECT_NEAR(mixture.components[0].variance(0), 10.0, 1e-12);
  EXPECT_NEAR(mixture.components[0].variance(1), 1.2, 1e-12);
  EXPECT_NEAR(mixture.components[0].share, 1.0, 1e-12);
}

// sklearn 1.x: GaussianMixture(3, covariance_type="diag", reg_covar=1e-6, tol=1e-9, n_init=10) of
// the same 60 points, components by their first mean.
TEST(GaussianMixture, IsThatOfScikitLearn) {
  Eigen::MatrixXd points(2, 60);
  for (int i = 0; i < 60; ++i) {
    const int heap = i % 3;
    const double a = std::sin(1.7 * i + 0.3);
    const double b = std::cos(2.3 * i + 1.1);
    points(0, i) = std::array{0.0, 3.0, -2.0}.at(static_cast<std::size_t>(heap)) +
                   std::array{0.5, 0.3, 0.8}.at(static_cast<std::size_t>(heap)) * a;
    points(1, i) = std::array{0.0, 1.0, 4.0}.at(static_cast<std::size_t>(heap)) +
                   std::array{0.4, 0.7, 0.2}.at(static_cast<std::size_t>(heap)) * b;
  }
  MixtureOptions options;
  options.components = 3;
  options.least_gain = 1e-10;
  auto mixture = fit_mixture(points, options);
  ASSERT_EQ(mixture.components.size(), 3U);
  std::sort(mixture.components.begin(), mixture.components.end(), [](const auto& a, const auto& b) {
    return a.mean(0) < b.mean(0);
  });
  constexpr std::array kMeans = {
      -1.95427398, 3.99797798, -0.02999927, -0.00589716, 3.00330748, 1.01305548};
  constexpr std::array kVariances = {
      0.30399212, 0.02016572, 0.11742621, 0.07962563, 0.04724501, 0.24026166};
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(mixture.components[c].share, 1.0 / 3.0, 1e-6);
    for (Eigen::Index x = 0; x < 2; ++x) {
      const std::size_t i = 2 * c + static_cast<std::size_t>(x);
      EXPECT_NEAR(mixture.components[c].mean(x), kMeans.at(i), 1e-5);
      EXPECT_NEAR(mixture.components[c].variance(x), kVariances.at(i), 1e-5);
    }
  }
  EXPECT_NEAR(mixture.mean_log_likelihood, -1.562252132376403, 1e-5);
}

TEST(GaussianMixture, HasNoMoreComponentsThanPoints) {
  const auto mixture = fit_mixture(Eigen::MatrixXd::Random(2, 3), {});
  EXPECT_LE(mixture.components.size(), 3U);
  EXPECT_GE(mixture.components.size(), 1U);
  EXPECT_TRUE(fit_mixture(Eigen::MatrixXd(2, 0), {}).components.empty());
}

// numpy.polyfit of power over log10 of distance: -18.56124105, -30.01114545.
TEST(PathLossLaw, IsTheLineOfLeastSquares) {
  const std::array distance = {1.0, 1.3, 1.7, 2.0, 2.4, 2.9, 3.3, 3.8, 4.2, 5.0, 5.5, 6.1};
  const std::array power = {-30, -33, -33, -36, -37, -39, -39, -42, -40, -43, -44, -45};
  std::vector<PowerAtDistance> places;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    places.push_back({distance.at(i), static_cast<double>(power.at(i))});
  }
  const auto law = fit_path_loss_law(places);
  ASSERT_TRUE(law);
  EXPECT_NEAR(law->exponent, 1.856124105, 1e-8);
  EXPECT_NEAR(law->at_1m_dbm, -30.01114545, 1e-7);
  EXPECT_NEAR(law->sigma_db, 0.8596941, 1e-6);
  EXPECT_NEAR(law->at(10.0), -30.01114545 - 18.56124105, 1e-7);
  places.resize(9);
  EXPECT_FALSE(fit_path_loss_law(places)) << "nine places are too few";
  EXPECT_FALSE(fit_path_loss_law(std::vector<PowerAtDistance>(20, {2.0, -30.0})));
}

TEST(PhaseErrors, SeparateGaussianErrorsFromOutliers) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.3);
  std::uniform_real_distribution<double> uniform(-kPi, kPi);
  std::vector<double> errors;
  for (int i = 0; i < 4000; ++i) {
    errors.push_back(i % 4 == 0 ? uniform(random) : normal(random));
  }
  const PhaseErrors fit = fit_phase_errors(errors);
  EXPECT_NEAR(fit.sigma, 0.3, 0.02);
  EXPECT_NEAR(fit.outliers, 0.25, 0.03);
  EXPECT_EQ(fit_phase_errors(std::vector{1.0, 2.0}).sigma, PhaseErrors{}.sigma);
}

AntennaArray wide_array() {
  AntennaArray array;
  array.element_offset = {{0, 0.089, 0}, {0, -0.089, 0}, {0, 0, 0}};
  return array;
}

TEST(Bearing, MatchesAPlaneWaveForADistantSender) {
  const AntennaArray array = wide_array();
  const auto line = antenna_line(array, {0, 1, 2});
  ASSERT_TRUE(line);
  EXPECT_THAT(line->element, ElementsAre(1, 2, 0));
  EXPECT_NEAR(line->spacing, 0.089, 1e-12);
  const double wavelength = 0.0577;
  for (const double degrees : {-60.0, -10.0, 0.0, 35.0}) {
    const double angle = degrees / 180.0 * kPi;
    const Vec3d far{1e4 * std::cos(angle), 1e4 * std::sin(angle), 0.0};
    EXPECT_NEAR(psi_of(array, *line, far, wavelength),
                2.0 * kPi * 0.089 / wavelength * std::sin(angle),
                1e-3);
  }
}

TEST(Bearing, HasThreeOrFourAliasesAtOneAndAHalfWavelengths) {
  const double wavelength = 0.0577;
  for (const double u : {-0.8, 0.0, 0.31}) {
    const double psi = 2.0 * kPi * 0.089 / wavelength * u;
    const auto sines = sines_of(wrapped(psi), 0.089, wavelength);
    EXPECT_GE(sines.size(), 3U);
    EXPECT_LE(sines.size(), 4U);
    EXPECT_TRUE(std::any_of(
        sines.begin(), sines.end(), [&](double sine) { return std::abs(sine - u) < 1e-9; }));
    for (const double sine : sines) {
      EXPECT_LE(std::abs(sine), 1.0);
      EXPECT_NEAR(wrapped(2.0 * kPi * 0.089 / wavelength * sine - psi), 0.0, 1e-9);
    }
    EXPECT_EQ(sines_of(wrapped(kPi * u), 0.5, 1.0).size(), 1U) << "half a wavelength";
  }
}

TEST(Bearing, NeedsALineOfEqualSteps) {
  AntennaArray array = wide_array();
  EXPECT_FALSE(antenna_line(array, {2}));
  EXPECT_TRUE(antenna_line(array, {0, 1})) << "without the middle one";
  array.element_offset[2].y = 0.03;
  EXPECT_FALSE(antenna_line(array, {0, 1, 2}));
  array.element_offset[2] = {0.05, 0, 0};
  EXPECT_FALSE(antenna_line(array, {0, 1, 2}));
}

}  // namespace
}  // namespace rayloc::paths_test
