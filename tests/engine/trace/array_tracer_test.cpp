#include "engine/trace/array_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "engine/base/constants.h"
#include "tests/support/scenes.h"

namespace rayloc::array_tracer_test {
namespace {

AntennaArray row() {
  AntennaArray array;
  array.pose = {{0.4, -0.2, 2.1}, {0.7, 0.1, -0.2}};
  array.element_offset = {{0.01, -0.089, 0.0}, {0, 0, 0}, {-0.02, 0.089, 0.03}};
  return array;
}

std::shared_ptr<const Scene> room() {
  return test::make_scene({{"room", test::box_mesh({-9, -9, 0}, {9, 9, 3})}}, test::kConcrete);
}

OfdmGrid grid() {
  OfdmGrid grid{test::kCarrier, 312'500.0, {}};
  for (std::int16_t i = -57; i <= 57; ++i) {
    grid.tone_index.push_back(i);
  }
  return grid;
}

const Transmitter kDevice{{{-5.0, 4.0, 1.1}, {0.2, 0.3, 0.4}}};

TEST(ArrayTracer, ElementsAreTracedAsReceiversOfTheirOwn) {
  const PathTracer tracer(room());
  const ArrayTracer array(tracer, row());
  const std::vector<Paths> paths = array.trace(kDevice);
  const std::vector<Receiver> elements = array_elements<Receiver>(row());
  ASSERT_EQ(paths.size(), 3U);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const Paths alone = tracer.trace(kDevice, elements[i]);
    ASSERT_EQ(paths[i].size(), alone.size());
    for (std::size_t p = 0; p < alone.size(); ++p) {
      EXPECT_EQ(paths[i][p].tau, alone[p].tau);
      EXPECT_EQ(paths[i][p].a.re, alone[p].a.re);
    }
  }
}

TEST(ArrayTracer, PlaneWaveIsRightToTheCurvatureOfTheWave) {
  const PathTracer tracer(room());
  const ArrayTracer exact(tracer, row());
  const ArrayTracer plane(tracer, row(), ArrayMode::kPlaneWave);
  const std::vector<Paths> expected = exact.trace(kDevice);
  const std::vector<Paths> paths = plane.trace(kDevice);
  double worst = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(paths[i].size(), expected[i].size());
    const Vec3d offset = row().element_offset[i];
    for (std::size_t p = 0; p < paths[i].size(); ++p) {
      const double length = expected[i][p].tau * kSpeedOfLight;
      const double error = std::abs(paths[i][p].tau * kSpeedOfLight - length);
      EXPECT_LE(error, 0.6 * dot(offset, offset) / length);
      worst = std::max(worst, error);
    }
  }
  EXPECT_GT(worst, 1e-5);
}

TEST(ArrayTracer, GradientOfAnArrayMatchesDifferences) {
  const PathTracer tracer(room());
  const ArrayTracer array(tracer, row());
  const auto reference = array_csi(array.trace({{{-5.02, 4.01, 1.13}, {}}}), grid());
  const auto loss = [&](const Transmitter& device) {
    const auto h = array_csi(array.trace(device), grid());
    double sum = 0.0;
    for (std::size_t j = 0; j < h.size(); ++j) {
      sum += std::norm(h[j] - reference[j]);
    }
    return sum;
  };
  const std::vector<Paths> paths = array.trace(kDevice);
  auto g = array_csi(paths, grid());
  for (std::size_t j = 0; j < g.size(); ++j) {
    g[j] = 2.0 * (g[j] - reference[j]);
  }
  const std::vector<Parameter> parameters{Parameter::transmitter_position(0),
                                          Parameter::transmitter_position(1)};
  const auto derivatives = array.differentiate(kDevice, paths, parameters);
  ASSERT_TRUE(derivatives);
  const auto gradient = array_loss_gradient(*derivatives, paths, grid(), g);
  constexpr double kStep = 1e-5;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto at = [&](double by) {
      Transmitter device = kDevice;
      (axis == 0 ? device.position.x : device.position.y) += by;
      return loss(device);
    };
    const double numeric =
        (at(-2 * kStep) - 8 * at(-kStep) + 8 * at(kStep) - at(2 * kStep)) / (12 * kStep);
    EXPECT_NEAR(gradient[axis], numeric, 1e-6 * std::abs(numeric));
  }
}

TEST(ArrayTracer, RefusesUnsupportedDerivatives) {
  RadioMaterial earth = test::kConcrete;
  earth.thickness = kHalfSpace;
  const PathTracer tracer(test::make_scene(
      {{"ground", test::rectangle_mesh({-9, -9, 0}, {18, 0, 0}, {0, 18, 0})}}, earth));
  const ArrayTracer plane(tracer, row(), ArrayMode::kPlaneWave);
  const std::vector<Paths> waves = plane.trace(kDevice);
  const std::vector<Parameter> position{Parameter::transmitter_position(0)};
  EXPECT_FALSE(plane.differentiate(kDevice, waves, position));

  const ArrayTracer array(tracer, row());
  const std::vector<Paths> paths = array.trace(kDevice);
  EXPECT_TRUE(array.differentiate(kDevice, paths, position));
  const auto refused = [&](const Parameter& parameter, const std::string& why) {
    const auto derivatives = array.differentiate(kDevice, paths, std::vector{parameter});
    ASSERT_FALSE(derivatives);
    EXPECT_NE(derivatives.error().message.find(why), std::string::npos)
        << derivatives.error().message;
  };
  refused(Parameter::thickness(0), "half space");
  refused(Parameter::thickness(7), "material 7");
  refused(Parameter::object_translation(3, 0), "object 3");
  refused(Parameter::surface_offset(9), "surface 9");
  refused(Parameter::receiver_position(3), "axis 3");
}

}  // namespace
}  // namespace rayloc::array_tracer_test
