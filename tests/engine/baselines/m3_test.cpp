#include "engine/baselines/m3/m3.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/base/median.h"
#include "engine/baselines/m3/reflectors.h"
#include "engine/baselines/paths/sage.h"
#include "tests/support/scenes.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::m3_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kLight = 299'792'458.0;  // [m/s]
constexpr double kTwoPi = 2.0 * std::numbers::pi;

// A channel of 20 MHz, every second tone.
OfdmGrid channel(int number) {
  OfdmGrid grid{5e9 + 5e6 * number, 312'500.0, {}};
  for (int k = -28; k <= 28; k += 2) {
    if (k != 0) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}
const std::vector<int> kHops = {36, 40, 44, 48, 52, 56, 60, 64};

std::vector<OfdmGrid> channels() {
  std::vector<OfdmGrid> all;
  all.reserve(kHops.size());
  for (const int number : kHops) {
    all.push_back(channel(number));
  }
  return all;
}

std::vector<Eigen::MatrixXcd> modelled(const Sage& sage, std::span<const SagePath> paths) {
  std::vector<Eigen::MatrixXcd> h;
  for (std::size_t hop = 0; hop < sage.hops().size(); ++hop) {
    h.push_back(sage.model(paths, hop));
  }
  return h;
}

TEST(Sage, ModelIsTheFormulaOfAPath) {
  const Sage sage({channel(36)}, 0.089, 3);
  const SagePath path{0.3, 12e-9, {0.5, 0.2}};
  const Eigen::MatrixXcd h = sage.model({&path, 1}, 0);
  const double f = 5.18e9 + 312'500.0 * channel(36).tone_index[5];
  const auto expected = path.amplitude *
                        std::polar(1.0, kTwoPi * 5.18e9 * 2.0 * 0.089 * 0.3 / kLight) *
                        std::polar(1.0, -kTwoPi * f * 12e-9);
  EXPECT_NEAR(std::abs(h(2, 5) - expected), 0.0, 1e-6);
}

TEST(Sage, FindsTwoPathsOfOneChannelAtHalfAWavelength) {
  SageOptions options;
  options.paths = 2;
  const Sage sage({channel(36)}, 0.029, 3, options);
  // On the grid, and further apart than the band resolves.
  const std::vector<SagePath> truth = {{-0.5, 5e-9, 1.0}, {0.4, 55e-9, {0.0, 0.6}}};
  const auto found = sage.paths(modelled(sage, truth));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].u, -0.5, 0.06);
  EXPECT_NEAR(found[0].tau, 5e-9, 1.5e-9);
  EXPECT_NEAR(found[1].u, 0.4, 0.06);
  EXPECT_NEAR(found[1].tau, 55e-9, 2.5e-9);
}

// 10 ns are 3 m: eight channels of 20 MHz resolve these paths, one does not.
TEST(Sage, HopsAreOneWideBand) {
  const std::vector<SagePath> truth = {{-0.5, 0.0, 1.0}, {0.4, 10e-9, {0.0, 0.6}}};
  SageOptions options;
  options.paths = 2;
  const Sage wide(channels(), 0.089, 3, options);
  auto found = wide.paths(modelled(wide, truth));
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.tau < b.tau; });
  EXPECT_NEAR(found[0].u, -0.5, 0.02);
  EXPECT_NEAR(found[0].tau, 0.0, 0.6e-9);
  EXPECT_NEAR(found[1].u, 0.4, 0.02);
  EXPECT_NEAR(found[1].tau, 10e-9, 0.6e-9);
  EXPECT_NEAR(std::abs(found[1].amplitude), 0.6, 0.05);
}

RoomModel one_access_point() {
  RoomModel room = test::make_room();
  room.access_points.resize(1);
  return room;
}

const M3& m3() {
  static const M3 kM3 = *M3::create(std::make_shared<const RoomModel>(one_access_point()), {});
  return kM3;
}

AntennaLine line_of(const RoomModel& room) {
  return *antenna_line(room.access_points[0].array, {0, 1, 2});
}

// Where the device seems to be in no mirror and in the `mirrors` walls that are furthest away.
std::vector<Vec3d> images(const RoomModel& room, const Vec3d& place, std::size_t mirrors) {
  std::vector<Vec3d> all = {place};
  const auto planes = reflectors_of(room, room.access_points[0].array.pose.position);
  for (auto plane = planes.rbegin(); plane != planes.rend() && all.size() <= mirrors; ++plane) {
    if (is_vertical(*plane)) {
      all.push_back(mirrored(*plane, place));
    }
  }
  return all;
}

double error_of(const LocationEstimate& estimate, const Vec3d& truth) {
  return estimate.position
             ? std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y)
             : 10.0;
}

std::vector<Vec3d> places(int count) {
  std::mt19937 random(11);
  std::vector<Vec3d> all;
  for (int i = 0; i < count; ++i) {
    const double x = static_cast<double>(random()) / 4294967296.0;
    const double y = static_cast<double>(random()) / 4294967296.0;
    all.push_back({-1.3 + 2.6 * x, -1.0 + 2.0 * y, 1.2});
  }
  return all;
}

TEST(M3, UsesTheWallsAndTheFloor) {
  const RoomModel& room = m3().room();
  const auto mirrors = reflectors_of(room, room.access_points[0].array.pose.position);
  EXPECT_EQ(mirrors.size(), 5U) << "four walls and the floor, one face each; there is no ceiling";
  EXPECT_EQ(std::count_if(mirrors.begin(), mirrors.end(), is_vertical), 4);
  const Vec3d image = mirrored({{1.0, 0.0, 0.0}, 1.5}, {0.3, 0.2, 1.2});
  EXPECT_NEAR(image.x, 2.7, 1e-12);
  EXPECT_NEAR(image.y, 0.2, 1e-12);
}

TEST(M3, FindsThePlaceOfExactPaths) {
  const RoomModel& room = m3().room();
  const auto& array = room.access_points[0].array;
  const AntennaLine line = line_of(room);
  const double wavelength = kLight / 5.18e9;
  std::vector<double> errors;
  for (const Vec3d& truth : places(20)) {
    M3Paths received{0, line, wavelength, 180e6, {}};
    for (const Vec3d& image : images(room, truth, 4)) {
      received.paths.push_back(
          {psi_of(array, line, image, wavelength) * wavelength / (kTwoPi * line.spacing),
           norm(image - array.pose.position) / kLight,
           1.0});
    }
    std::sort(received.paths.begin(), received.paths.end(), [](const auto& a, const auto& b) {
      return a.tau < b.tau;
    });
    LocationEstimate estimate;
    m3().summarise({&received, 1}, estimate);
    errors.push_back(error_of(estimate, truth));
  }
  EXPECT_LT(median(errors), 0.06);
}

// The channel of an access point from a device and `walls` of its images; every hop has its own
// factor, delay and noise (40 dB).
M3Received received_by_hops(const RoomModel& room,
                            const Vec3d& place,
                            std::span<const int> hops,
                            std::size_t walls,
                            unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 0.01 / std::sqrt(2.0));
  std::uniform_real_distribution<double> uniform;
  M3Received received{0, line_of(room), {}};
  const auto& array = room.access_points[0].array;
  const auto seen = images(room, place, walls);
  for (const int number : hops) {
    M3Hop hop{channel(number), {}};
    hop.h = Eigen::MatrixXcd::Zero(3, static_cast<Eigen::Index>(hop.grid.size()));
    const double delay = 300e-9 * uniform(random);
    const auto factor = std::polar(1.0, kTwoPi * uniform(random));
    for (Eigen::Index m = 0; m < 3; ++m) {
      for (Eigen::Index k = 0; k < hop.h.cols(); ++k) {
        const auto tone = static_cast<std::size_t>(k);
        for (std::size_t i = 0; i < seen.size(); ++i) {
          const double r =
              norm(seen[i] -
                   element_position(array, received.line.element[static_cast<std::size_t>(m)]));
          hop.h(m, k) += std::polar((i == 0 ? 1.0 : 0.6) / r,
                                    -kTwoPi * hop.grid.frequency_hz(tone) * r / kLight);
        }
        const double real = normal(random);
        hop.h(m, k) =
            factor * (std::polar(1.0, -kTwoPi * hop.grid.offset_hz(tone) * delay) * hop.h(m, k) +
                      std::complex<double>(real, normal(random)));
      }
    }
    received.hops.push_back(std::move(hop));
  }
  return received;
}

// Over 40 places: a quarter of the estimates are an alias away, so medians of fewer places jump.
double median_error(std::span<const int> hops) {
  std::vector<double> errors;
  unsigned seed = 1;
  for (const Vec3d& truth : places(40)) {
    const M3Paths paths = m3().find_paths(received_by_hops(m3().room(), truth, hops, 2, seed++));
    LocationEstimate estimate;
    m3().summarise({&paths, 1}, estimate);
    errors.push_back(error_of(estimate, truth));
  }
  return median(errors);
}

TEST(M3, LocatesByHopsAndNotByOneChannel) {
  const double hopped = median_error(kHops);
  EXPECT_LE(hopped, 0.2);
  // Physics: a single channel of 20 MHz resolves little in comparison.
  EXPECT_GT(median_error(std::span(kHops).first(1)), 2.0 * hopped);
}

TEST(M3, ReportsTheResolutionOfOneChannel) {
  const auto room = std::make_shared<const RoomModel>(test::make_room());
  const auto all = M3::create(room, {});
  ASSERT_TRUE(all);
  const auto estimate = all->locate(test::frames_at(*room, {0.3, 0.2, 1.2}));
  EXPECT_TRUE(estimate.position);
  EXPECT_EQ(estimate.access_points_used, 3U);
  EXPECT_THAT(estimate.warnings,
              Contains("m3 without channel hopping: in 36.3 MHz it separates paths that differ by "
                       "8.3 m"));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto again = all->locate(test::frames_at(*room, {0.3, 0.2, 1.2}));
  EXPECT_EQ(again.position, estimate.position);
  EXPECT_EQ(again.covariance, estimate.covariance);
}

TEST(M3, RefusesWithoutWallsFramesAndAntennas) {
  RoomModel open = one_access_point();
  open.scene = test::make_scene({{"floor", test::box_mesh({-1.5, -1.2, -0.1}, {1.5, 1.2, 0})}},
                                test::kConcrete);
  const auto refused = M3::create(std::make_shared<const RoomModel>(open), {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kConfiguration);
  EXPECT_EQ(refused.error().message,
            "no vertical plane of 1 m2 or more of the scene bounds the room: m3 needs reflectors "
            "at known places");
  EXPECT_EQ(m3().locate({}).reason, "no frames");
  RoomModel single = one_access_point();
  RoomAccessPoint& ap = single.access_points[0];
  ap.array.element_offset.resize(1);
  ap.rx_chains.resize(1);
  ap.gains.rx_chains.resize(1);
  ap.gains.gain.resize(single.grid.size());
  const auto frames = test::frames_at(m3().room(), {0.3, 0.2, 1.2});
  EXPECT_THAT(M3::create(std::make_shared<const RoomModel>(single), {})->locate(frames).reason,
              HasSubstr("a has 1 usable antenna: a bearing needs 2"));
}

}  // namespace
}  // namespace rayloc::m3_test
