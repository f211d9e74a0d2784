#include "engine/trace/scattering/scattering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "engine/base/constants.h"
#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::scattering_test {
namespace {

using Value = std::complex<double>;

constexpr double kWavelength = kSpeedOfLight / test::kCarrier;
constexpr double kWavenumber = 2.0 * std::numbers::pi / kWavelength;
const RadioMaterial kConductor{"conductor", 1.0, 1e9, kHalfSpace};
// Far below everything: a scene needs a surface.
const Mesh kFarAway = test::rectangle_mesh({-1, -1, -1000}, {2, 0, 0}, {0, 2, 0});

Value value(const Complex<double>& z) { return {z.re, z.im}; }

// At the carrier.
Value channel(const Path& path) {
  return value(path.a) * std::polar(1.0, -kWavenumber * kSpeedOfLight * path.tau);
}
Value channel(const Paths& paths) {
  Value sum;
  for (const Path& path : paths) {
    sum += channel(path);
  }
  return sum;
}

Transmitter transmitter_at(const Vec3d& position,
                           Polarization polarization = Polarization::kVertical) {
  return Transmitter{{position, {}, AntennaPattern::kIsotropic, polarization}};
}
Receiver receiver_at(const Vec3d& position, Polarization polarization = Polarization::kVertical) {
  return Receiver{{position, {}, AntennaPattern::kIsotropic, polarization}};
}

TargetTracer tracer(const std::shared_ptr<const Scene>& scene,
                    const TargetBody& body,
                    int max_depth,
                    double softness = 0.0) {
  ScatteringOptions options;
  options.trace.max_depth = max_depth;
  options.trace.softness = softness;
  options.negligible = 0.0;
  auto created = TargetTracer::create(scene, body, options);
  if (!created) {
    ADD_FAILURE() << created.error().message;
    std::abort();
  }
  return *created;
}

Paths scattered(const TargetTracer& tracer,
                const Transmitter& transmitter,
                const Receiver& receiver,
                const TargetPosition& position) {
  auto paths = tracer.link(transmitter, receiver).trace(position);
  EXPECT_TRUE(paths) << paths.error().message;
  return paths ? *paths : Paths();
}

std::shared_ptr<const Scene> nothing() {
  return test::make_scene({{"far", kFarAway}}, test::kConcrete);
}

std::shared_ptr<const Scene> meeting_room() {
  auto scene = load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  EXPECT_TRUE(scene);
  return std::make_shared<const Scene>(std::move(*scene));
}

TEST(Scattering, BodyOnTheLineOfSightCancelsTheDirectPath) {
  const TargetTracer past = tracer(nothing(), TargetBody{}, 0);
  for (const auto polarization : {Polarization::kVertical, Polarization::kHorizontal}) {
    const Transmitter tx = transmitter_at({-2.0, 0.1, 1.1}, polarization);
    const Receiver rx = receiver_at({1.5, 0.0, 0.9}, polarization);
    const Value direct = channel(PathTracer(nothing(), {.max_depth = 0}).trace(tx, rx));
    const Value shadow = channel(scattered(past, tx, rx, {0.0, 0.05}));
    // Right behind its middle the waves around both sides add up.
    EXPECT_LT(std::abs(direct + shadow), 0.4 * std::abs(direct));
    // Two metres aside it hardly matters.
    EXPECT_LT(std::abs(channel(scattered(past, tx, rx, {0.0, 2.0}))), 0.2 * std::abs(direct));
  }
}

TEST(Scattering, PairHasTheDelayOfThePathViaTheBody) {
  const TargetTracer past = tracer(nothing(), TargetBody{}, 0);
  const Vec3d tx{-2.0, 0.0, 1.0};
  const Vec3d rx{1.5, 0.0, 1.0};
  const Paths aside = scattered(past, transmitter_at(tx), receiver_at(rx), {0.0, 1.5});
  ASSERT_EQ(aside.size(), 1U);
  // By the point of the body that reflects, as seen from its axis.
  const Vec3d axis{0.0, 1.5, 1.0};
  const Vec3d towards = normalized(tx - axis) + normalized(rx - axis);
  const Vec3d point = axis + (0.2 / norm(towards)) * towards;
  EXPECT_NEAR(aside[0].tau * kSpeedOfLight, norm(tx - point) + norm(point - rx), 1e-3);
  const Paths between = scattered(past, transmitter_at(tx), receiver_at(rx), {0.0, 0.0});
  EXPECT_NEAR(between[0].tau * kSpeedOfLight, norm(tx - rx), 1e-9);
}

// A path by way of a mirror, past the body before or behind it, is the path of the image.
TEST(Scattering, ReflectedPathIsShadowedAsThatOfTheImage) {
  const auto wall = test::make_scene(
      {{"wall", test::rectangle_mesh({-50, 3, -50}, {100, 0, 0}, {0, 0, 100})}}, kConductor);
  const Vec3d tx{-2.0, 0.2, 1.3};
  const Vec3d image{-2.0, 5.8, 1.3};
  const Vec3d rx{1.8, 0.1, 1.0};
  const TargetTracer with_wall = tracer(wall, TargetBody{}, 1);
  const TargetTracer alone = tracer(nothing(), TargetBody{}, 0);
  const Paths empty = PathTracer(wall, {.max_depth = 1}).trace(transmitter_at(tx), receiver_at(rx));
  ASSERT_EQ(empty.size(), 2U);
  const Value path = channel(empty[1]);
  const Value image_path = channel(
      PathTracer(nothing(), {.max_depth = 0}).trace(transmitter_at(image), receiver_at(rx)));
  // On the way from the wall to the receiver, at its edge, and aside.
  for (const TargetPosition& position :
       {TargetPosition{0.9, 1.45}, {1.0, 1.0}, {1.1, 1.5}, {-0.3, 1.0}}) {
    const Paths pairs = scattered(with_wall, transmitter_at(tx), receiver_at(rx), position);
    // Direct and direct, then reflected and direct, direct and reflected.
    ASSERT_EQ(pairs.size(), 3U);
    const std::size_t reflected_first = std::abs(pairs[1].interactions[0].position.x - tx.x) <
                                                std::abs(pairs[2].interactions[0].position.x - tx.x)
                                            ? 1
                                            : 2;
    const Value ratio = channel(pairs[reflected_first]) / path;
    const Paths pair = scattered(alone, transmitter_at(image), receiver_at(rx), position);
    ASSERT_EQ(pair.size(), 1U);
    EXPECT_NEAR(std::abs(ratio - channel(pair[0]) / image_path), 0.0, 1e-3)
        << position.x << " " << position.y;
  }
}

// A body on a conducting floor, and its image below: together a body twice as tall, past which the
// images of the ends count as sources of their own.
TEST(Scattering, FloorMakesTheImageOfTheBody) {
  const auto floor = test::make_scene(
      {{"floor", test::rectangle_mesh({-50, -50, 0}, {100, 0, 0}, {0, 100, 0})}}, kConductor);
  TargetBody half;
  TargetBody whole = half;
  whole.base = -half.height;
  whole.height = 2.0 * half.height;
  const TargetTracer on_floor = tracer(floor, half, 2);
  const TargetTracer doubled = tracer(nothing(), whole, 0);
  const Vec3d tx{-2.0, 0.1, 0.9};
  const Vec3d rx{1.8, 0.0, 0.6};
  const Vec3d rx_image{rx.x, rx.y, -rx.z};
  // Theta^ of the image's wave, mirrored, is opposite to that of the reflected wave: with a
  // conductor's r_tm = 1 the reflected path counts as the image's with the same sign for upright
  // fields.
  for (const TargetPosition& position : {TargetPosition{0.0, 0.1}, {0.2, 0.35}, {-0.5, 1.0}}) {
    const Value sum = channel(scattered(on_floor, transmitter_at(tx), receiver_at(rx), position));
    const Value direct = channel(scattered(doubled, transmitter_at(tx), receiver_at(rx), position));
    const Value image =
        channel(scattered(doubled, transmitter_at(tx), receiver_at(rx_image), position));
    EXPECT_LT(std::abs(sum - (direct + image)), 0.05 * (std::abs(direct) + std::abs(image)))
        << position.x << " " << position.y;
  }
}

TEST(Scattering, IsReciprocal) {
  const TargetTracer past = tracer(meeting_room(), TargetBody{{0.22, 0.15}, 0.4}, 2);
  RadioDevice a{
      {0.4, 1.0, 1.5}, {0.3, -0.2, 0.5}, AntennaPattern::kHalfWaveDipole, Polarization::kVertical};
  RadioDevice b{{-1.4, -1.05, 1.2}, {0.1, 0.4, -0.1}, AntennaPattern::kDipole};
  b.polarization = Polarization::kHorizontal;
  const Paths forth = scattered(past, Transmitter{a}, Receiver{b}, {-0.3, 0.2});
  const Paths back = scattered(past, Transmitter{b}, Receiver{a}, {-0.3, 0.2});
  ASSERT_EQ(forth.size(), back.size());
  ASSERT_GT(forth.size(), 20U);
  const Value want = channel(forth);
  EXPECT_LT(std::abs(channel(back) - want), 1e-9 * std::abs(want));
}

TEST(Scattering, DerivativesByThePositionMatchCentralDifferences) {
  constexpr double kStep = 1e-6;
  const auto scene = meeting_room();
  const Transmitter tx = transmitter_at({0.4, 1.0, 1.5});
  const Receiver rx = receiver_at({-1.4, -1.05, 1.2});
  double worst = 0.0;
  for (const double softness : {0.0, 0.1}) {
    for (const TargetBody& body : {TargetBody{}, TargetBody{{0.22, 0.15}, 0.4}}) {
      const TargetLink link = tracer(scene, body, 2, softness).link(tx, rx);
      for (const TargetPosition& at : {TargetPosition{-0.3, 0.2}, {-0.5, -0.02}, {0.6, -0.4}}) {
        const auto here = link.differentiate(at);
        ASSERT_TRUE(here) << here.error().message;
        ASSERT_GT(here->paths.size(), 30U);
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const TargetPosition step{axis == 0 ? kStep : 0.0, axis == 1 ? kStep : 0.0};
          const auto high = link.trace({at.x + step.x, at.y + step.y});
          const auto low = link.trace({at.x - step.x, at.y - step.y});
          ASSERT_TRUE(high && low);
          ASSERT_EQ(high->size(), here->paths.size());
          ASSERT_EQ(low->size(), here->paths.size());
          for (std::size_t i = 0; i < here->paths.size(); ++i) {
            const auto& derivative = here->by_position.at(i, axis);
            const Value slope = (value((*high)[i].a) - value((*low)[i].a)) / (2.0 * kStep);
            const double error = std::abs(value(derivative.a) - slope);
            // Near an extremum its own size counts, over a wavelength's turn; and softness leaves
            // paths that are as good as none.
            const double free_space = kWavelength / (4.0 * std::numbers::pi * 3.0);
            const double size = std::abs(slope) + kWavenumber * (std::abs(value(here->paths[i].a)) +
                                                                 1e-6 * free_space);
            worst = std::max(worst, error / size);
            const double tau = ((*high)[i].tau - (*low)[i].tau) / (2.0 * kStep);
            EXPECT_NEAR(derivative.tau, tau, 1e-6 * (std::abs(tau) + 1.0 / kSpeedOfLight)) << i;
          }
        }
      }
    }
  }
  RecordProperty("worst_in_billionths", std::to_string(1e9 * worst));
  EXPECT_LT(worst, 1e-6);
}

TEST(Scattering, ChannelIsContinuousAsTheBodyWalks) {
  // A room that holds nothing, so that all its chains reach every place.
  const auto room =
      test::make_scene({{"room", test::box_mesh({-3, -3, 0}, {3, 3, 2.6})}}, test::kConcrete);
  const TargetLink link = tracer(room, TargetBody{}, 1)
                              .link(transmitter_at({-2, 0.3, 1.2}), receiver_at({2, -0.2, 1.5}));
  Value last;
  double largest = 0.0;
  for (int i = 0; i <= 800; ++i) {
    const auto paths = link.trace({0.4, -1.0 + 2.5e-3 * i});
    ASSERT_TRUE(paths);
    const Value now = channel(*paths);
    largest = std::max(largest, std::abs(now));
    if (i > 0) {
      // A step of 2.5 mm turns the way there and back by 0.54 at the most.
      EXPECT_LT(std::abs(now - last), 0.54 * kWavelength / (4.0 * std::numbers::pi * 4.0)) << i;
    }
    last = now;
  }
  EXPECT_GT(largest, 0.8 * kWavelength / (4.0 * std::numbers::pi * 4.0));
}

// Also at impossible places of a body: in walls, in furniture, under the access point.
TEST(Scattering, IsFiniteEverywhere) {
  const TargetLink link =
      tracer(meeting_room(), TargetBody{}, 2)
          .link(transmitter_at({0.4, 1.0, 1.5}), receiver_at({-1.4, -1.05, 2.4}));
  std::size_t count = 0;
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) {
      const auto traced = link.differentiate({0.2 * i, 0.2 * j + 0.15});
      for (std::size_t p = 0; traced && p < traced->paths.size(); ++p) {
        const Path& path = traced->paths[p];
        ASSERT_TRUE(std::isfinite(abs2(path.a) + path.tau)) << i << " " << j;
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const auto& derivative = traced->by_position.at(p, axis);
          ASSERT_TRUE(std::isfinite(abs2(derivative.a) + derivative.tau)) << i << " " << j;
        }
        ++count;
      }
    }
  }
  EXPECT_GT(count, 1000U);
}

TEST(Scattering, ThinBodyDoesNothing) {
  TargetBody thread;
  thread.semi_axes = {1e-4, 1e-4};
  thread.relative_permittivity = 3.0;
  thread.conductivity = 0.01;
  const Transmitter tx = transmitter_at({0.4, 1.0, 1.5});
  const Receiver rx = receiver_at({-1.4, -1.05, 1.2});
  const Paths empty = PathTracer(meeting_room(), {.max_depth = 2}).trace(tx, rx);
  const Paths paths = scattered(tracer(meeting_room(), thread, 2), tx, rx, {-0.5, -0.02});
  EXPECT_LT(std::abs(channel(paths)), 1e-3 * std::abs(channel(empty)));
}

TEST(Scattering, BothRaysTogetherHaveAtMostTheDepth) {
  const TargetTracer past = tracer(meeting_room(), TargetBody{}, 2);
  const Paths paths = scattered(
      past, transmitter_at({0.4, 1.0, 1.5}), receiver_at({-1.4, -1.05, 1.2}), {-0.3, 0.2});
  ASSERT_GT(paths.size(), 30U);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    EXPECT_LE(paths[i].interactions.size(), 2U);
    if (i > 0) {
      EXPECT_GE(paths[i].interactions.size(), paths[i - 1].interactions.size());
    }
  }
}

TEST(Scattering, NegligiblePairsAreSmall) {
  const Transmitter tx = transmitter_at({0.4, 1.0, 1.5});
  const Receiver rx = receiver_at({-1.4, -1.05, 1.2});
  ScatteringOptions options;
  options.trace.max_depth = 2;
  options.negligible = 0.05;
  const auto few = TargetTracer::create(meeting_room(), TargetBody{}, options);
  ASSERT_TRUE(few);
  const Paths all = scattered(tracer(meeting_room(), TargetBody{}, 2), tx, rx, {-0.3, 0.2});
  const Paths kept = scattered(*few, tx, rx, {-0.3, 0.2});
  ASSERT_LT(kept.size(), all.size());
  const double limit =
      options.negligible * kWavelength / (4.0 * std::numbers::pi * norm(tx.position - rx.position));
  EXPECT_LT(std::abs(channel(all) - channel(kept)),
            limit * static_cast<double>(all.size() - kept.size()));
}

TEST(Scattering, LinksOfAnArrayAreThoseOfItsElements) {
  const TargetTracer past = tracer(meeting_room(), TargetBody{}, 1);
  const Transmitter tx = transmitter_at({0.4, 1.0, 1.5});
  const std::vector<Receiver> receivers{receiver_at({-1.4, -1.05, 1.2}),
                                        receiver_at({-1.35, -1.0, 1.2})};
  const std::vector<TargetLink> links = past.links(tx, receivers);
  ASSERT_EQ(links.size(), 2U);
  for (std::size_t i = 0; i < links.size(); ++i) {
    EXPECT_EQ(channel(*links[i].trace({-0.3, 0.2})),
              channel(scattered(past, tx, receivers[i], {-0.3, 0.2})));
  }
}

TEST(Scattering, WavesReachTheBodyThroughAWall) {
  const auto wall = test::make_scene({{"wall", test::box_mesh({-0.9, -5, 0}, {-0.8, 5, 3})}},
                                     {"board", 2.0, 0.01, 0.01});
  ScatteringOptions options;
  options.trace.max_depth = 2;
  const Transmitter tx = transmitter_at({-2, 0, 1});
  const Receiver rx = receiver_at({2, 0, 1});
  const auto opaque = TargetTracer::create(wall, TargetBody{}, options);
  options.trace.transmission = true;
  const auto clear = TargetTracer::create(wall, TargetBody{}, options);
  ASSERT_TRUE(opaque && clear);
  EXPECT_TRUE(opaque->link(tx, rx).trace({0, 0})->empty());
  const auto paths = clear->link(tx, rx).trace({0, 0});
  ASSERT_FALSE(paths->empty());
  const Value direct = channel(PathTracer(wall, options.trace).trace(tx, rx)[0]);
  EXPECT_LT(std::abs(direct + channel((*paths)[0])), 0.3 * std::abs(direct));
}

TEST(Scattering, RefusesInvalidBodiesAndPositions) {
  const auto scene = nothing();
  const auto message = [&](const TargetBody& body, const ScatteringOptions& options = {}) {
    const auto created = TargetTracer::create(scene, body, options);
    return created ? std::string("accepted") : created.error().message;
  };
  TargetBody body;
  body.conductivity = -1.0;
  EXPECT_EQ(message(body), "body: conductivity is -1.000000, must be 0 or more [S/m]");
  body = {};
  body.semi_axes = {0.0, 0.2};
  EXPECT_NE(message(body).find("a semi-axis is 0"), std::string::npos);
  ScatteringOptions options;
  options.negligible = -1.0;
  EXPECT_EQ(message({}, options), "scattering: negligible is -1.000000, must be 0 or more");
  options = {};
  options.height_step = 0.0;
  EXPECT_EQ(message({}, options), "scattering: height_step is 0.000000, must be more than 0 [m]");
  options = {};
  options.trace.max_depth = -1;
  EXPECT_EQ(message({}, options), "scattering: trace.max_depth is -1.000000, must be 0 or more");
  options = {};
  options.trace.softness = -0.1;
  EXPECT_NE(message({}, options).find("trace.softness"), std::string::npos);

  const TargetLink link =
      tracer(scene, TargetBody{}, 0).link(transmitter_at({-2, 0, 1}), receiver_at({2, 0, 1}));
  const auto refused = [&](double x, double y) {
    const auto paths = link.trace({x, y});
    return paths ? std::string("accepted") : paths.error().message;
  };
  EXPECT_EQ(refused(-1.9, 0.1),
            "body at (-1.900000, 0.100000): the transmitter is inside it; move the body or make it "
            "smaller");
  EXPECT_NE(refused(2.0, 0.0).find("the receiver is inside it"), std::string::npos);
  EXPECT_NE(refused(std::numeric_limits<double>::quiet_NaN(), 0.0).find("finite"),
            std::string::npos);
  EXPECT_FALSE(link.differentiate({2.0, 0.0}));
}

}  // namespace
}  // namespace rayloc::scattering_test
