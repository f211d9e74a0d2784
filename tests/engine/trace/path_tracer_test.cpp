#include "engine/trace/path_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "engine/base/constants.h"
#include "engine/scene/read/load_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::path_tracer_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWavelength = kSpeedOfLight / test::kCarrier;

Transmitter transmitter_at(const Vec3d& position) { return Transmitter{{position, {}}}; }
Receiver receiver_at(const Vec3d& position) { return Receiver{{position, {}}}; }

std::complex<double> value(const Complex<double>& z) { return {z.re, z.im}; }

std::shared_ptr<const Scene> meeting_room() {
  auto scene = load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  EXPECT_TRUE(scene);
  return std::make_shared<const Scene>(std::move(*scene));
}

// A floor so large that its edges are out of sight.
std::shared_ptr<const Scene> ground(const RadioMaterial& material) {
  return test::make_scene(
      {{"ground", test::rectangle_mesh({-500, -500, 0}, {1000, 0, 0}, {0, 1000, 0})}}, material);
}

TEST(PathTracer, LineOfSightIsFriis) {
  const auto scene = ground(test::kConcrete);
  const Vec3d tx{1, 2, 3};
  const Vec3d rx{4, -2, 3};
  const Paths paths =
      PathTracer(scene, {.max_depth = 0}).trace(transmitter_at(tx), receiver_at(rx));
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_NEAR(paths[0].a.re, kWavelength / (4 * kPi * 5.0), 1e-17);
  EXPECT_EQ(paths[0].a.im, 0.0);
  EXPECT_NEAR(paths[0].tau * kSpeedOfLight, 5.0, 1e-14);
  EXPECT_NEAR(paths[0].theta_t(), kPi / 2, 1e-15);
  EXPECT_NEAR(paths[0].phi_t(), std::atan2(-4, 3), 1e-15);
  EXPECT_NEAR(paths[0].phi_r(), std::atan2(4, -3), 1e-15);  // towards the transmitter
}

// h = lambda / 4 pi (exp(-jkd) / d + R exp(-jkr) / r), R of Fresnel for a half space.
TEST(PathTracer, TwoRayGroundMatchesClosedForm) {
  RadioMaterial earth = test::kConcrete;
  earth.thickness = kHalfSpace;
  const auto scene = ground(earth);
  const std::complex<double> eta = value(complex_permittivity(earth, test::kCarrier));
  const double ht = 2.0;
  const double hr = 1.5;
  for (const double distance : {0.5, 3.0, 20.0, 150.0}) {
    const double direct = std::hypot(distance, ht - hr);
    const double reflected = std::hypot(distance, ht + hr);
    const double cos_i = (ht + hr) / reflected;
    const std::complex<double> root = std::sqrt(eta - (1.0 - cos_i * cos_i));
    const std::complex<double> r_tm = (eta * cos_i - root) / (eta * cos_i + root);
    const std::complex<double> r_te = (cos_i - root) / (cos_i + root);
    for (const auto polarization : {Polarization::kVertical, Polarization::kHorizontal}) {
      Transmitter tx = transmitter_at({0, 0, ht});
      Receiver rx = receiver_at({distance, 0, hr});
      tx.polarization = polarization;
      rx.polarization = polarization;
      const Paths paths = PathTracer(scene).trace(tx, rx);
      ASSERT_EQ(paths.size(), 2U);
      const bool vertical = polarization == Polarization::kVertical;
      // theta^ of the two ends agree for the direct ray; phi^ are opposite, hence the signs. For
      // the parallel part the geometry of both ends is in the pattern, which is isotropic.
      const double sign = vertical ? 1.0 : -1.0;
      EXPECT_NEAR(paths[0].a.re, sign * kWavelength / (4 * kPi * direct), 1e-15);
      const std::complex<double> expected =
          sign * kWavelength / (4 * kPi * reflected) * (vertical ? r_tm : r_te);
      EXPECT_LE(std::abs(value(paths[1].a) - expected), 1e-14) << distance << " " << vertical;
      EXPECT_NEAR(paths[1].tau * kSpeedOfLight, reflected, 1e-12);
    }
  }
}

TEST(PathTracer, CornerReflectorSendsBack) {
  const auto scene =
      test::make_scene({{"floor", test::rectangle_mesh({-9, -9, 0}, {9, 0, 0}, {0, 18, 0})},
                        {"wall", test::rectangle_mesh({0, -9, 0}, {0, 18, 0}, {0, 0, 9})}},
                       {"metal", 1.0, 1e7, 0.1});
  const Vec3d tx{-2.0, 0.3, 1.0};
  const Vec3d rx{-2.2, 0.0, 1.5};
  const Paths paths = PathTracer(scene).trace(transmitter_at(tx), receiver_at(rx));
  ASSERT_EQ(paths.size(), 4U);  // direct, floor, wall, both
  const Path& both = paths[3];
  ASSERT_EQ(both.interactions.size(), 2U);
  EXPECT_NEAR(both.tau * kSpeedOfLight, norm(rx - Vec3d{-tx.x, tx.y, -tx.z}), 1e-12);
  // It comes from where it was sent to, in the plane across the edge.
  EXPECT_NEAR(std::cos(both.theta_t()), std::cos(both.theta_r()), 1e-12);
}

TEST(PathTracer, ColocatedEndsReceiveTheEcho) {
  const auto scene = ground(test::kConcrete);
  const Vec3d here{0.3, 0.2, 1.7};
  const Paths paths = PathTracer(scene).trace(transmitter_at(here), receiver_at(here));
  ASSERT_EQ(paths.size(), 1U);  // no line of sight to oneself
  EXPECT_NEAR(paths[0].tau * kSpeedOfLight, 3.4, 1e-12);
  EXPECT_NEAR(paths[0].theta_t(), kPi, 1e-15);
  EXPECT_EQ(paths[0].theta_t(), paths[0].theta_r());
  EXPECT_EQ(paths[0].phi_t(), paths[0].phi_r());
  EXPECT_TRUE(std::isfinite(paths[0].a.re) && std::isfinite(paths[0].a.im));
}

TEST(PathTracer, IsReciprocal) {
  const PathTracer tracer(meeting_room(), {.max_depth = 3});
  Transmitter tx{{{0.4, 1.0, 1.5},
                  {0.3, -0.2, 0.5},
                  AntennaPattern::kHalfWaveDipole,
                  Polarization::kVertical}};
  Receiver rx{
      {{-1.4, 1.05, 1.2}, {-1.1, 0.4, 0.15}, AntennaPattern::kDipole, Polarization::kHorizontal}};
  const Paths there = tracer.trace(tx, rx);
  const Paths back = tracer.trace(Transmitter{static_cast<RadioDevice>(rx)},
                                  Receiver{static_cast<RadioDevice>(tx)});
  ASSERT_EQ(there.size(), back.size());
  ASSERT_GT(there.size(), 20U);
  for (const Path& path : there) {
    bool found = false;
    for (const Path& other : back) {
      if (std::abs(path.tau - other.tau) < 1e-21 &&
          path.interactions.size() == other.interactions.size() &&
          std::abs(path.theta_t() - other.theta_r()) < 1e-12 &&
          std::abs(path.phi_t() - other.phi_r()) < 1e-12) {
        found = true;
        EXPECT_LE(std::abs(value(path.a) - value(other.a)), 1e-15);
      }
    }
    EXPECT_TRUE(found) << path.tau;
  }
}

// Turns and shifts the whole world: nothing that a receiver could measure changes.
TEST(PathTracer, IsInvariantUnderRigidMotion) {
  const auto original = meeting_room();
  const Orientation turn{0.7, -0.4, 1.1};
  const Vec3d shift{3.0, -8.0, 2.0};
  const auto moved = [&](const Vec3d& v) { return rotation(turn) * v + shift; };
  Scene::Input input{original->objects(), original->materials(), original->carrier_hz()};
  for (SceneObject& object : input.objects) {
    for (Vec3d& v : object.mesh.vertices) {
      v = moved(v);
    }
  }
  auto rotated = Scene::create(std::move(input));
  ASSERT_TRUE(rotated);
  EXPECT_EQ(rotated->surfaces().size(), original->surfaces().size());
  const Vec3d tx{0.4, 1.0, 1.5};
  const Vec3d rx{-1.4, 1.05, 1.2};
  const Paths before = PathTracer(original).trace(transmitter_at(tx), receiver_at(rx));
  const Paths after = PathTracer(std::make_shared<const Scene>(std::move(*rotated)))
                          .trace(Transmitter{{moved(tx), turn}}, Receiver{{moved(rx), turn}});
  ASSERT_EQ(before.size(), after.size());
  ASSERT_GT(before.size(), 15U);
  for (const Path& path : before) {
    double nearest = 1.0;
    for (const Path& other : after) {
      if (std::abs(path.tau - other.tau) < 1e-19) {
        nearest = std::min(nearest, std::abs(value(path.a) - value(other.a)));
      }
    }
    EXPECT_LE(nearest, 1e-14) << path.tau;
  }
}

TEST(PathTracer, BoxInBetweenBlocks) {
  const Vec3d tx{-2, 0, 1};
  const Vec3d rx{2, 0, 1};
  const auto scene =
      test::make_scene({{"box", test::box_mesh({-0.5, -0.5, 0}, {0.5, 0.5, 2})}}, test::kConcrete);
  EXPECT_TRUE(PathTracer(scene).trace(transmitter_at(tx), receiver_at(rx)).empty());
  EXPECT_EQ(PathTracer(scene).trace(transmitter_at({-2, 0, 3}), receiver_at({2, 0, 3})).size(), 2U);
}

TEST(PathTracer, DeviceInsideAClosedBoxReceivesNothingFromOutside) {
  const auto scene =
      test::make_scene({{"box", test::box_mesh({0, 0, 0}, {1, 1, 1})}}, test::kConcrete);
  const PathTracer tracer(scene);
  EXPECT_TRUE(tracer.trace(transmitter_at({0.5, 0.5, 0.5}), receiver_at({2, 2, 2})).empty());
  EXPECT_TRUE(tracer.trace(transmitter_at({2, 2, 2}), receiver_at({0.5, 0.5, 0.5})).empty());
}

TEST(PathTracer, BothSidesOfASheetReflect) {
  const auto scene = test::make_scene(
      {{"sheet", test::rectangle_mesh({0, -2, 0}, {0, 4, 0}, {0, 0, 4})}}, test::kConcrete);
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(
        PathTracer(scene).trace(transmitter_at({side, -1, 2}), receiver_at({side, 1, 2})).size(),
        2U);
  }
}

TEST(PathTracer, HoleInAWallDoesNotReflectAndLetsThrough) {
  // A wall of 3 x 3 m without its middle: four boards around it, one object.
  Mesh wall;
  const auto add = [&](const Mesh& board) {
    const auto base = static_cast<std::uint32_t>(wall.vertices.size());
    wall.vertices.insert(wall.vertices.end(), board.vertices.begin(), board.vertices.end());
    for (const auto& t : board.triangles) {
      wall.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    }
  };
  add(test::rectangle_mesh({0, 0, 0}, {0, 3, 0}, {0, 0, 1}));
  add(test::rectangle_mesh({0, 0, 2}, {0, 3, 0}, {0, 0, 1}));
  add(test::rectangle_mesh({0, 0, 1}, {0, 1, 0}, {0, 0, 1}));
  add(test::rectangle_mesh({0, 2, 1}, {0, 1, 0}, {0, 0, 1}));
  const auto scene = test::make_scene({{"wall", wall}}, test::kConcrete);
  ASSERT_EQ(scene->surfaces().size(), 1U);
  const PathTracer tracer(scene);
  const auto count = [&](const Vec3d& tx, const Vec3d& rx) {
    return tracer.trace(transmitter_at(tx), receiver_at(rx)).size();
  };
  EXPECT_EQ(count({1, 1.4, 1.5}, {1, 1.6, 1.5}), 1U);   // nothing to reflect at
  EXPECT_EQ(count({1, 0.4, 1.5}, {1, 0.6, 1.5}), 2U);   // a board
  EXPECT_EQ(count({1, 1.5, 1.5}, {-1, 1.5, 1.5}), 1U);  // through the hole
  EXPECT_EQ(count({1, 0.5, 1.5}, {-1, 0.5, 1.5}), 0U);  // into a board
}

TEST(PathTracer, PathAlongAWallIsKept) {
  const auto scene = ground(test::kConcrete);
  const PathTracer tracer(scene);
  // On the ground: the direct path only; a millimetre above it: the grazing reflection as well.
  EXPECT_EQ(tracer.trace(transmitter_at({0, 0, 0}), receiver_at({5, 1, 0})).size(), 1U);
  EXPECT_EQ(tracer.trace(transmitter_at({0, 0, 1e-3}), receiver_at({5, 1, 1e-3})).size(), 2U);
}

TEST(PathTracer, PathsComeInCanonicalOrder) {
  const Paths paths =
      PathTracer(meeting_room()).trace(transmitter_at({0.4, 1.0, 1.5}), receiver_at({-1, 0, 1.2}));
  for (std::size_t i = 1; i < paths.size(); ++i) {
    EXPECT_LE(paths[i - 1].interactions.size(), paths[i].interactions.size());
  }
  EXPECT_TRUE(paths[0].interactions.empty());
}

TEST(PathTracer, ReceiverTracerMatchesTrace) {
  const PathTracer tracer(meeting_room());
  const Receiver rx = receiver_at({-1.4, 1.05, 1.2});
  const ReceiverTracer at = tracer.at(rx);
  for (const double x : {-1.0, 0.0, 1.3}) {
    const Transmitter tx = transmitter_at({x, 0.2, 1.1});
    const Paths once = tracer.trace(tx, rx);
    const Paths cached = at.trace(tx);
    ASSERT_EQ(once.size(), cached.size());
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_EQ(once[i].tau, cached[i].tau);
      EXPECT_EQ(value(once[i].a), value(cached[i].a));
    }
  }
}

TEST(ArrayElements, FollowThePoseOfTheArray) {
  AntennaArray array;
  array.pose = {{1, 2, 3}, {kPi / 2, 0, 0}};
  array.element_offset = {{0, -0.089, 0}, {0, 0, 0}, {0, 0.089, 0}};
  array.pattern = AntennaPattern::kHalfWaveDipole;
  const auto elements = array_elements<Receiver>(array);
  ASSERT_EQ(elements.size(), 3U);
  EXPECT_NEAR(norm(elements[0].position - Vec3d{1.089, 2, 3}), 0.0, 1e-15);
  EXPECT_EQ(elements[0].pattern, AntennaPattern::kHalfWaveDipole);
}

}  // namespace
}  // namespace rayloc::path_tracer_test
