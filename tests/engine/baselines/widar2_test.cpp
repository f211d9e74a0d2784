// Paths of a moving person, and the components that estimate them.
#include "engine/baselines/widar2/widar2.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Dense>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/baselines/motion/band_pass.h"
#include "engine/baselines/motion/conjugate_product.h"
#include "engine/baselines/motion/motion_sage.h"
#include "engine/baselines/motion/range_smoother.h"
#include "engine/baselines/widar2/path_link.h"
#include "tests/support/synthetic_room.h"
#include "tests/support/walking_echo.h"

namespace rayloc::widar2_test {
namespace {

using ::testing::HasSubstr;

constexpr double kStep = 0.0025;         // [s], 400 frames/s
constexpr double kWavelength = 0.05776;  // [m]
constexpr double kTwoPi = 2.0 * std::numbers::pi;
const MacAddress kPlug = *parse_mac_address("02:00:00:00:00:09");

// Printed by SciPy 1.17.1: sos = butter(4, [low, high], 'band', fs=rate, output='sos'), then
// sosfiltfilt() of real and imaginary part.
TEST(BandPass, IsThatOfSciPy) {
  struct Case {
    double high;
    double rate;
    std::array<std::complex<double>, 6> values;
  };
  const std::array<std::size_t, 6> at = {0, 1, 30, 60, 90, 119};
  const std::array cases = {Case{50.0,
                                 400.0,
                                 {{{0.372249265363, 0.333859042619},
                                   {0.32925576285, -0.003170809553},
                                   {-0.157917434563, -0.394197452786},
                                   {-0.817787890187, -0.828849058178},
                                   {0.019985303126, 0.030253491473},
                                   {-0.243689996944, -0.136828628203}}}},
                            Case{45.0,
                                 100.0,
                                 {{{0.060171602712, -0.038698354181},
                                   {-0.378451260963, -1.49781176044},
                                   {0.909653242997, 1.071994556815},
                                   {0.27607703402, 0.930414515851},
                                   {-0.24666571245, 0.968775648546},
                                   {-0.110119368051, -0.040355922499}}}}};
  for (const Case& one : cases) {
    std::vector<std::complex<double>> x;
    for (int n = 0; n < 120; ++n) {
      const double t = kTwoPi * n / one.rate;
      x.emplace_back(std::cos(17.0 * t) + 3.0 + 0.5 * std::sin(0.5 * t), std::cos(30.0 * t + 0.3));
    }
    const auto y = BandPass(2.0, one.high, one.rate).filtered(x);
    ASSERT_EQ(y.size(), x.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      EXPECT_NEAR(y[at.at(i)].real(), one.values.at(i).real(), 1e-9) << at.at(i);
      EXPECT_NEAR(y[at.at(i)].imag(), one.values.at(i).imag(), 1e-9) << at.at(i);
    }
  }
}

// A static term and a moving term: the phase of the product follows the moving path.
TEST(ConjugateProduct, RotatesWithTheMovingPathOnly) {
  constexpr int kTimes = 400;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> phase(0.0, kTwoPi);
  Eigen::MatrixXcd h(3, kTimes);                         // one tone of three antennas
  const std::array<double, 3> share = {0.9, 0.5, 0.05};  // of the moving path at each antenna
  for (int t = 0; t < kTimes; ++t) {
    const auto frame = std::polar(1.0, phase(random));
    for (int m = 0; m < 3; ++m) {
      h(m, t) =
          frame * (std::polar(1.0, 0.4 * m) +
                   share.at(static_cast<std::size_t>(m)) *
                       std::polar(1.0, 0.9 * m + 1.0 - kTwoPi * 1.0 * kStep * t / kWavelength));
    }
  }
  const ConjugateProduct made = conjugate_product(h, 3);
  EXPECT_EQ(made.reference, 2U) << "the antenna that varies least";
  const auto energy = [&](int antenna, double rate) {
    std::complex<double> sum = 0.0;
    for (int t = 0; t < kTimes; ++t) {
      sum += made.product(antenna, t) * std::polar(1.0, kTwoPi * rate * kStep * t / kWavelength);
    }
    return std::norm(sum);
  };
  EXPECT_GT(energy(0, 1.0), 4.0 * energy(0, -1.0)) << "the right sense is the stronger one";
  EXPECT_GT(energy(0, 1.0), 100.0 * energy(0, 1.7));
  EXPECT_NEAR(energy(2, 1.0), energy(2, -1.0), 1e-6 * energy(2, 1.0))
      << "the reference against itself is real";
}

std::vector<double> tones() {
  std::vector<double> hz;
  for (int k = -58; k <= 58; k += 4) {
    hz.push_back(312'500.0 * k);
  }
  return hz;
}

Eigen::MatrixXcd window_of(const MotionPath& path, double size, std::size_t reference) {
  const auto hz = tones();
  const auto n = static_cast<Eigen::Index>(hz.size());
  Eigen::MatrixXcd window(3 * n, 40);
  for (Eigen::Index m = 0; m < 3; ++m) {
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index t = 0; t < 40; ++t) {
        const double steps = static_cast<double>(m) - static_cast<double>(reference);
        window(m * n + k, t) =
            std::polar(size,
                       path.psi * steps - kTwoPi * hz[static_cast<std::size_t>(k)] * path.delay -
                           kTwoPi * path.rate * kStep * static_cast<double>(t) / kWavelength);
      }
    }
  }
  return window;
}

TEST(MotionSage, FindsTwoPathsByTheirFormula) {
  const MotionPath strong{1.2, 18e-9, 0.7, 0.0};
  const MotionPath weak{-0.6, 60e-9, -1.9, 0.0};
  const Eigen::MatrixXcd window = window_of(strong, 1.0, 1) + window_of(weak, 0.4, 1);
  const MotionSage sage(tones(), 3, 40, kStep, kWavelength, {.paths = 2});
  const auto paths = sage.paths(window, 1);
  ASSERT_EQ(paths.size(), 2U);
  for (const auto& [found, truth] : {std::pair(paths[0], strong), std::pair(paths[1], weak)}) {
    EXPECT_NEAR(found.rate, truth.rate, 0.051);
    EXPECT_NEAR(found.delay, truth.delay, 2.1e-9);
    EXPECT_NEAR(found.psi, truth.psi, 0.09);
  }
  EXPECT_NEAR(paths[1].energy / paths[0].energy, 0.16, 0.03);
}

TEST(PathLink, FollowsOnePathAndNotTheLoudest) {
  PathLink link(3);
  std::vector<MotionPath> decoded;
  for (int i = 0; i < 20; ++i) {
    // The target, and something that jumps and is louder every other time.
    const double jump = i % 2 == 0 ? 2.0 : -2.0;
    const auto path =
        link.add({{jump, 90e-9, jump, i % 2 == 0 ? 1.5 : 0.5}, {0.5 + 0.02 * i, 10e-9, 0.3, 1.0}});
    EXPECT_EQ(path.has_value(), i >= 3);
    if (path) {
      decoded.push_back(*path);
    }
  }
  ASSERT_EQ(decoded.size(), 17U);
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    EXPECT_NEAR(decoded[i].rate, 0.5 + 0.02 * static_cast<double>(i), 1e-12) << "three windows ago";
  }
}

// By numpy, in the matrix form of a smoother of the whole series: the mean of Gaussian increments
// and measurements, solved as one linear system.
TEST(RangeSmoother, IsTheLeastSquaresOfAllSteps) {
  constexpr std::size_t kLag = 6;
  RangeSmoother smoother({.rate_sigma = 2.0, .sigma_floor = 0.5, .least = 0.0, .lag = kLag});
  const std::array<double, 7> rate = {0.0, 1.0, 1.2, 0.8, -0.5, 0.3, 0.9};
  const std::array<double, 7> measured = {4.1, 4.0, 4.4, 4.2, 4.1, 4.3, 4.2};
  for (std::size_t i = 0; i < rate.size(); ++i) {
    smoother.add(rate.at(i), 0.1, measured.at(i));
  }
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(7, 7);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(7);
  for (Eigen::Index i = 0; i < 7; ++i) {
    const auto n = static_cast<std::size_t>(i);
    normal(i, i) += 1.0 / 0.25;
    right(i) += measured.at(n) / 0.25;
    if (i > 0) {
      const double weight = 1.0 / (0.2 * 0.2);
      normal(i, i) += weight;
      normal(i - 1, i - 1) += weight;
      normal(i, i - 1) -= weight;
      normal(i - 1, i) -= weight;
      right(i) += weight * 0.1 * rate.at(n);
      right(i - 1) -= weight * 0.1 * rate.at(n);
    }
  }
  const Eigen::MatrixXd covariance = normal.inverse();
  // The first measurement is the prior: the filter begins with it.
  ASSERT_TRUE(smoother.is_ready());
  const SmoothedRange first = smoother.smoothed();
  EXPECT_NEAR(first.length, (covariance * right)(0), 1e-9);
  EXPECT_NEAR(first.variance, covariance(0, 0), 1e-9);
}

TEST(Widar2, RangeIsTheInverseOfTheLength) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d transmitter{uniform(random), uniform(random), 0.0};
    const Vec3d place{uniform(random), uniform(random), 0.0};
    const double r = norm(place);
    const double length = r + norm(place - transmitter);
    EXPECT_NEAR(range_of(length, transmitter, (1.0 / r) * place), r, 1e-9 * (1.0 + 1e3 * r));
  }
  EXPECT_LT(range_of(1.0, {2.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 0.0) << "shorter than straight on";
}

std::shared_ptr<const RoomModel> room() {
  static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
  return kRoom;
}

const Widar2Link kLink = {kPlug, {1.0, -0.6, 1.2}, {0, 1, 2}};

Timestamp at(double seconds) { return Timestamp(from_seconds(seconds)); }

std::vector<CsiFrame> walk(double seconds, double step, const std::function<Vec3d(double)>& place) {
  return test::frames_past(*room(), {kPlug, kLink.position}, seconds, step, place);
}

std::vector<LocationEstimate> received(Widar2& widar2, const std::vector<CsiFrame>& frames) {
  std::vector<LocationEstimate> out;
  for (std::size_t i = 0; i < frames.size(); i += 240) {  // bursts of 0.2 s
    widar2.receive(std::span(frames).subspan(i, std::min<std::size_t>(240, frames.size() - i)),
                   out);
  }
  return out;
}

Widar2Options a_point() {
  Widar2Options options;
  options.body = 0.0;
  return options;
}

// A circle on one side of the lines of sight.
Vec3d around(double t) {
  return {0.2 + 0.35 * std::cos(1.2 * t), 0.4 + 0.35 * std::sin(1.2 * t), 1.2};
}

TEST(Widar2, FollowsAPointThatWalks) {
  const auto place = around;
  auto widar2 = *Widar2::create(room(), kLink, a_point());
  const auto estimates = received(widar2, walk(4.0, kStep, place));
  ASSERT_GT(estimates.size(), 15U);
  std::vector<double> errors;
  for (const LocationEstimate& estimate : estimates) {
    ASSERT_TRUE(estimate.position);
    const Vec3d truth = place(to_seconds(estimate.time.time_since_epoch()));
    errors.push_back(std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.25) << errors.back();
  EXPECT_EQ(widar2.problem(), "");
  auto again = *Widar2::create(room(), kLink, a_point());
  const auto same = received(again, walk(4.0, kStep, place));
  ASSERT_EQ(same.size(), estimates.size());
  EXPECT_EQ(same.back().position->x, estimates.back().position->x);
}

TEST(Widar2, OneLinkLeavesItsAliases) {
  const auto place = around;
  auto widar2 = *Widar2::create(room(), {kPlug, kLink.position, {0}}, a_point());
  const auto estimates = received(widar2, walk(4.0, kStep, place));
  ASSERT_FALSE(estimates.empty());
  std::vector<double> nearest;
  for (const LocationEstimate& estimate : estimates) {
    const Vec3d truth = place(to_seconds(estimate.time.time_since_epoch()));
    double best = 1e9;
    for (const Hypothesis& one : estimate.hypotheses) {
      best = std::min(best, std::hypot(one.position.x - truth.x, one.position.y - truth.y));
    }
    nearest.push_back(best);
    EXPECT_GT(estimate.hypotheses.size(), 1U);
  }
  std::sort(nearest.begin(), nearest.end());
  EXPECT_LT(nearest[nearest.size() / 2], 0.4);
}

TEST(Widar2, RefusesUnusableFramesWithAMessage) {
  auto still = *Widar2::create(room(), kLink, {});
  const auto estimates = received(still, walk(3.5, kStep, [](double) {
                                    return Vec3d{0.2, 0.3, 1.2};
                                  }));
  EXPECT_EQ(still.problem(), "nothing moves: widar2 sees only what moves");
  EXPECT_LT(estimates.size(), 8U) << "until a second without motion is over";
  auto slow = *Widar2::create(room(), kLink, {});
  EXPECT_TRUE(received(slow,
                       walk(2.0,
                            0.02,
                            [](double t) {
                              return Vec3d{0.3 * t, 0.0, 1.2};
                            }))
                  .empty());
  EXPECT_THAT(slow.problem(),
              HasSubstr("50 frames/s of 02:00:00:00:00:09 at a: widar2 needs 104 (4 v_max / "
                        "wavelength); send more often, or lower v_max"));
  RoomModel one_antenna = test::make_room();
  one_antenna.access_points.resize(1);
  one_antenna.access_points[0].rx_chains.resize(1);
  one_antenna.access_points[0].array.element_offset.resize(1);
  one_antenna.access_points[0].gains = test::make_gains(one_antenna, 0);
  const auto refused = Widar2::create(
      std::make_shared<const RoomModel>(one_antenna), {kPlug, kLink.position, {0}}, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("a has 1 usable antenna: a bearing needs 2"));
}

TEST(Widar2, RefusesARoomWithoutTonesGainsOrAnAccessPoint) {
  const auto message = [](const RoomModel& model, const Widar2Link& link) {
    const auto refused = Widar2::create(std::make_shared<const RoomModel>(model), link, {});
    EXPECT_FALSE(refused);
    return refused ? std::string() : refused.error().message;
  };
  RoomModel odd = test::make_room();
  odd.grid.tone_index = {1, 2, 3, 5, 8};
  EXPECT_THAT(message(odd, kLink), HasSubstr("widar2 needs tones in equal steps"));
  RoomModel uncalibrated = test::make_room();
  for (RoomAccessPoint& ap : uncalibrated.access_points) {
    ap.gains = {};
  }
  EXPECT_THAT(message(uncalibrated, kLink), HasSubstr("calibrate the site"));
  EXPECT_THAT(message(test::make_room(), {kPlug, kLink.position, {}}),
              HasSubstr("widar2 needs an access point that receives the transmitter"));
}

TEST(Widar2, BeginsAnewAfterAGap) {
  const auto place = [](double t) { return Vec3d{-0.7 + 0.3 * t, 0.4, 1.2}; };
  auto widar2 = *Widar2::create(room(), kLink, {});
  auto frames = walk(6.0, 0.005, place);
  std::erase_if(frames,
                [](const CsiFrame& frame) { return frame.time > at(3.0) && frame.time < at(3.3); });
  const auto estimates = received(widar2, frames);
  const auto after = std::count_if(estimates.begin(), estimates.end(), [](const auto& estimate) {
    return estimate.time > at(3.3);
  });
  EXPECT_GT(after, 5);
}

}  // namespace
}  // namespace rayloc::widar2_test
