// Paths over one edge: against Fermat's principle, the uniform theory and a plain search.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/constants.h"
#include "engine/base/mat3.h"
#include "engine/em/wedge_diffraction.h"
#include "engine/scene/read/load_scene.h"
#include "engine/scene/wedges.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/plain_edge_search.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::edge_paths_test {
namespace {

using Cd = std::complex<double>;

constexpr double kWavelength = kSpeedOfLight / test::kCarrier;  // [m]
const RadioMaterial kMetal{"metal", 1.0, 1e7, 0.002};

// A sheet in the plane y = 0 with an upright free edge at x = 0; its other edges are far away.
std::shared_ptr<const Scene> half_plane(const RadioMaterial& material) {
  return test::make_scene({{"sheet", test::rectangle_mesh({0, 0, -50}, {100, 0, 0}, {0, 0, 100})}},
                          material);
}

Transmitter transmitter_at(const Vec3d& position) {
  Transmitter transmitter;
  transmitter.position = position;
  transmitter.orientation = {0.3, -0.2, 0.4};
  transmitter.pattern = AntennaPattern::kDipole;
  return transmitter;
}

Receiver receiver_at(const Vec3d& position) {
  Receiver receiver;
  receiver.position = position;
  receiver.orientation = {-0.5, 0.1, 0.2};
  receiver.pattern = AntennaPattern::kDipole;
  return receiver;
}

TraceOptions over_edges(int depth = 1) { return {.max_depth = depth, .diffraction = true}; }

// The paths over an edge alone.
std::vector<Path> diffracted_paths(const std::shared_ptr<const Scene>& scene,
                                   const Transmitter& transmitter,
                                   const Receiver& receiver,
                                   const TraceOptions& options = over_edges()) {
  std::vector<Path> found;
  for (const Path& path : PathTracer(scene, options).trace(transmitter, receiver)) {
    if (std::any_of(path.interactions.begin(), path.interactions.end(), [](const Interaction& i) {
          return is_edge(i.kind);
        })) {
      found.push_back(path);
    }
  }
  return found;
}

// Among the paths with nothing but the edge, the one over the upright edge at x = 0.
const Path* upright(const Scene& scene, const std::vector<Path>& paths) {
  const std::vector<Wedge> wedges = find_wedges(scene);
  const auto found = std::find_if(paths.begin(), paths.end(), [&](const Path& path) {
    const Interaction& met = path.interactions.front();
    return path.interactions.size() == 1 && std::abs(wedges[met.edge].along.z) > 0.9 &&
           std::abs(met.position.x) < 1e-9;
  });
  return found == paths.end() ? nullptr : &*found;
}

const Vec3d& bend_of(const Path& path) { return path.interactions.front().position; }
double length_of(const Path& path) { return path.tau * kSpeedOfLight; }

// At the carrier.
Cd field(const Complex<double>& a, double length) {
  return Cd{a.re, a.im} * std::polar(1.0, -2.0 * std::numbers::pi * length / kWavelength);
}

TEST(EdgePaths, PathOverTheEdgeIsTheShortest) {
  const auto scene = half_plane(kMetal);
  const Vec3d from{1.0, 2.0, 0.3};
  const Vec3d to{0.7, -3.0, 2.1};
  const auto paths = diffracted_paths(scene, transmitter_at(from), receiver_at(to));
  const Path* path = upright(*scene, paths);
  ASSERT_NE(path, nullptr);
  const auto length_over = [&](double z) {
    return norm(Vec3d{0.0, 0.0, z} - from) + norm(to - Vec3d{0.0, 0.0, z});
  };
  EXPECT_NEAR(length_of(*path), length_over(bend_of(*path).z), 1e-12);
  for (const double off : {-1e-3, 1e-3}) {
    EXPECT_LT(length_of(*path), length_over(bend_of(*path).z + off));
  }
  // Both legs make the same angle with the edge.
  EXPECT_NEAR(path->departure.z, -path->arrival.z, 1e-12);
}

TEST(EdgePaths, PowerIsThatOfTheHalfPlane) {
  const auto scene = half_plane(kMetal);
  Transmitter transmitter;
  transmitter.position = {1.0, 2.0, 0.0};
  Receiver receiver;
  receiver.position = {0.7, -3.0, 0.0};
  // Upright antennas: the field is along the edge.
  const auto paths = diffracted_paths(scene, transmitter, receiver);
  const Path* path = upright(*scene, paths);
  ASSERT_NE(path, nullptr);
  const double first = std::hypot(1.0, 2.0);
  const double second = std::hypot(0.7, 3.0);
  const Complex<double> relative = soft(wedge_terms<double>(
      {2.0,
       std::atan2(2.0, 1.0),
       2.0 * std::numbers::pi + std::atan2(-3.0, 0.7),
       2.0 * std::numbers::pi / kWavelength * first * second / (first + second)}));
  const double free = kWavelength / (4.0 * std::numbers::pi * (first + second));
  // The sheet is metal, which is not quite a perfect conductor.
  EXPECT_NEAR(path->a.re, free * relative.re, 1e-3 * free);
  EXPECT_NEAR(path->a.im, free * relative.im, 1e-3 * free);
}

TEST(EdgePaths, HiddenEdgesGiveNoPath) {
  const Vec3d from{1.0, 2.0, 0.3};
  const Vec3d to{0.7, -3.0, 2.1};
  const test::NamedMesh sheet{"sheet", test::rectangle_mesh({0, 0, -50}, {100, 0, 0}, {0, 0, 100})};
  const auto received = [&](const Vec3d& corner) {
    const auto scene = test::make_scene(
        {sheet, {"box", test::box_mesh(corner, corner + Vec3d{0.4, 0.4, 3.0})}}, kMetal);
    const auto paths = diffracted_paths(scene, transmitter_at(from), receiver_at(to));
    return upright(*scene, paths) != nullptr;
  };
  EXPECT_TRUE(received({3.0, 3.0, 0.0}));
  EXPECT_FALSE(received({0.3, 0.8, 0.0}));   // before the edge
  EXPECT_FALSE(received({0.1, -1.7, 0.0}));  // behind it
}

TEST(EdgePaths, EdgesEnd) {
  const auto scene = test::make_scene(
      {{"sheet", test::rectangle_mesh({0, 0, 0}, {100, 0, 0}, {0, 0, 1})}}, kMetal);
  const auto received = [&](double z) {
    const auto paths = diffracted_paths(scene, transmitter_at({1, 2, z}), receiver_at({1, -2, z}));
    return upright(*scene, paths) != nullptr;
  };
  EXPECT_TRUE(received(0.01));
  EXPECT_TRUE(received(0.99));
  EXPECT_FALSE(received(-0.01));
  EXPECT_FALSE(received(1.01));
}

TEST(EdgePaths, NothingBendsIntoABody) {
  // Seen from a face of a convex box, only that face's own four edges diffract.
  const auto scene = test::make_scene({{"box", test::box_mesh({0, 0, 0}, {1, 1, 1})}}, kMetal);
  const auto paths = diffracted_paths(
      scene, transmitter_at({0.4, 0.5, 3.0}), receiver_at({0.6, 0.4, 3.0}), over_edges(3));
  EXPECT_EQ(paths.size(), 4U);
  for (const Path& path : paths) {
    EXPECT_DOUBLE_EQ(bend_of(path).z, 1.0);
  }
}

// A room of six walls with a screen and a cabinet.
std::shared_ptr<const Scene> furnished(const RadioMaterial& material) {
  return test::make_scene(
      {{"room", test::box_mesh({-3, -2, 0}, {3, 2, 2.5})},
       {"cabinet", test::box_mesh({-0.4, -0.3, 0}, {0.5, 0.4, 1.3})},
       {"screen", test::rectangle_mesh({1.2, -0.9, 0.5}, {0.2, 0.8, 0}, {0, 0, 1.1})}},
      material);
}

// The interactions of a path, in the same form from either end.
std::vector<std::uint32_t> met_by(const Path& path, bool backwards) {
  std::vector<std::uint32_t> met;
  for (const Interaction& i : path.interactions) {
    met.push_back(i.surface);
    met.push_back(is_edge(i.kind) ? i.edge : is_mirror(i.kind) ? 1000U : 1001U);
  }
  if (backwards) {
    std::reverse(met.begin(), met.end());
    for (std::size_t i = 0; i + 1 < met.size(); i += 2) {
      std::swap(met[i], met[i + 1]);
    }
  }
  return met;
}

TEST(EdgePaths, EndsMayBeExchanged) {
  for (const RadioMaterial& material : {kMetal, test::kConcrete}) {
    for (const bool transmission : {false, true}) {
      const auto scene = furnished(material);
      TraceOptions options = over_edges(transmission ? 4 : 3);
      options.transmission = transmission;
      const Transmitter transmitter = transmitter_at({-1.7, 0.3, 1.8});
      const Receiver receiver = receiver_at({1.6, 1.2, 0.7});
      const auto there = diffracted_paths(scene, transmitter, receiver, options);
      const auto back = diffracted_paths(scene,
                                         Transmitter{static_cast<const RadioDevice&>(receiver)},
                                         Receiver{static_cast<const RadioDevice&>(transmitter)},
                                         options);
      ASSERT_EQ(there.size(), back.size());
      EXPECT_GT(there.size(), 50U);
      for (const Path& path : there) {
        const auto same = std::find_if(back.begin(), back.end(), [&](const Path& other) {
          return met_by(other, true) == met_by(path, false);
        });
        ASSERT_NE(same, back.end());
        EXPECT_NEAR(path.a.re, same->a.re, 1e-14);
        EXPECT_NEAR(path.a.im, same->a.im, 1e-14);
        EXPECT_NEAR(length_of(path), length_of(*same), 1e-12);
      }
    }
  }
}

double sharpest_bend(const std::vector<Cd>& values) {
  double most = 0.0;
  for (std::size_t i = 2; i < values.size(); ++i) {
    most = std::max(most, std::abs(values[i] - 2.0 * values[i - 1] + values[i - 2]));
  }
  return most;
}

// With the line of sight and one reflection, across both boundaries of light.
TEST(EdgePaths, ChannelIsContinuousWherePathsEnd) {
  for (const RadioMaterial& material : {kMetal, test::kConcrete}) {
    const auto scene = half_plane(material);
    const PathTracer specular(scene, {.max_depth = 1});
    const PathTracer whole_tracer(scene, over_edges());
    const Transmitter transmitter = transmitter_at({1.0, 2.0, 0.3});
    // Steps of a millimetre about the edge, from the lit side of the sheet round to its dark one.
    constexpr int kSteps = 20000;
    std::vector<Cd> straight;
    std::vector<Cd> whole;
    straight.reserve(kSteps);
    whole.reserve(kSteps);
    for (int i = 1; i < kSteps; ++i) {
      const double azimuth = 2.0 * std::numbers::pi * i / kSteps;
      const Receiver receiver =
          receiver_at({3.0 * std::cos(azimuth), 3.0 * std::sin(azimuth), 1.2});
      const auto sum = [&](const PathTracer& tracer) {
        Cd total;
        for (const Path& path : tracer.trace(transmitter, receiver)) {
          total += field(path.a, length_of(path));
        }
        return total;
      };
      straight.push_back(sum(specular));
      whole.push_back(sum(whole_tracer));
    }
    // The direct wave is 1e-3 to 3e-3 and turns by a tenth a step.
    EXPECT_GT(sharpest_bend(straight), 5e-4);
    EXPECT_LT(sharpest_bend(whole), 1e-4);
  }
}

// A floor below the screen: paths over floor and edge, before and after, end where others begin.
TEST(EdgePaths, ChannelIsContinuousBesideAWall) {
  const auto scene =
      test::make_scene({{"floor", test::rectangle_mesh({-60, -60, -1}, {120, 0, 0}, {0, 120, 0})},
                        {"sheet", test::rectangle_mesh({0, 0, -1}, {100, 0, 0}, {0, 0, 80})}},
                       test::kConcrete);
  const PathTracer specular(scene, {.max_depth = 2});
  const PathTracer whole_tracer(scene, over_edges(3));
  const Transmitter transmitter = transmitter_at({1.0, 2.0, 0.3});
  constexpr int kSteps = 4000;
  for (const double start : {0.55, 1.1}) {  // [pi], both boundaries lie within
    std::vector<Cd> straight;
    std::vector<Cd> whole;
    straight.reserve(kSteps);
    whole.reserve(kSteps);
    for (int i = 0; i < kSteps; ++i) {
      const double azimuth = std::numbers::pi * (start + 0.4 * i / kSteps);
      const Receiver receiver =
          receiver_at({3.0 * std::cos(azimuth), 3.0 * std::sin(azimuth), 1.2});
      const auto sum = [&](const PathTracer& tracer) {
        Cd total;
        for (const Path& path : tracer.trace(transmitter, receiver)) {
          total += field(path.a, length_of(path));
        }
        return total;
      };
      straight.push_back(sum(specular));
      whole.push_back(sum(whole_tracer));
    }
    EXPECT_GT(sharpest_bend(straight), 1e-4);
    EXPECT_LT(sharpest_bend(whole), 2e-5);
  }
}

// Returns how many paths there are.
std::size_t expect_all_found(const std::shared_ptr<const Scene>& scene,
                             const Vec3d& from,
                             const Vec3d& to) {
  std::set<std::vector<std::uint32_t>> found;
  for (const Path& path :
       diffracted_paths(scene, transmitter_at(from), receiver_at(to), over_edges(3))) {
    EXPECT_TRUE(found.insert(met_by(path, false)).second);
  }
  const auto expected = test::PlainEdgeSearch{*scene}.find(from, to, 2);
  std::vector<std::vector<std::uint32_t>> missed;
  std::vector<std::vector<std::uint32_t>> invented;
  std::set_difference(
      expected.begin(), expected.end(), found.begin(), found.end(), std::back_inserter(missed));
  std::set_difference(
      found.begin(), found.end(), expected.begin(), expected.end(), std::back_inserter(invented));
  EXPECT_EQ(missed, decltype(missed){});
  EXPECT_EQ(invented, decltype(invented){});
  return found.size();
}

TEST(EdgePaths, NoneIsMissedAndNoneInvented) {
  const auto scene = furnished(test::kConcrete);
  EXPECT_GT(expect_all_found(scene, {-1.7, 0.3, 1.8}, {1.6, 1.2, 0.7}), 100U);
  EXPECT_GT(expect_all_found(scene, {-0.9, -1.2, 0.6}, {2.1, -0.4, 1.9}), 100U);
}

TEST(EdgePaths, NoneIsMissedAndNoneInventedInTheSites) {
  for (const auto& [site, from, to] :
       {std::tuple("/sites/meeting_room", Vec3d{0.4, 1.0, 1.5}, Vec3d{-1.4, 0.55, 1.2}),
        std::tuple("/scenes/corridor", Vec3d{3.1, 0.7, 2.2}, Vec3d{5.4, -0.6, 1.0})}) {
    auto scene = load_scene(test::data_path() + site + "/scene.xml", {test::kCarrier, {}});
    ASSERT_TRUE(scene) << scene.error().message;
    const auto count = expect_all_found(std::make_shared<const Scene>(std::move(*scene)), from, to);
    EXPECT_GT(count, 0U) << site;
    if (std::getenv("RAYLOC_PRINT_PATHS") != nullptr) {
      std::printf("%s: %zu paths over an edge\n", site, count);
    }
  }
}

// Files hold vertices in single precision: faces then miss the edges that they meet at by as much.
TEST(EdgePaths, RoundedMeshesHaveTheSame) {
  const auto rotated = [](const Vec3d& v) {
    return rotation_from_yaw_pitch_roll(0.31, 0.0, 0.0) * v;
  };
  const auto paths_of = [&](bool round) {
    const auto made = [&](Mesh mesh) {
      for (Vec3d& v : mesh.vertices) {
        v = rotated(v);
        for (double* x : {&v.x, &v.y, &v.z}) {
          *x = round ? static_cast<double>(static_cast<float>(*x)) : *x;
        }
      }
      mesh.rounding = round ? 4e-7 : 0.0;
      return mesh;
    };
    const auto scene =
        test::make_scene({{"room", made(test::box_mesh({-3, -2, 0}, {3, 2, 2.5}))},
                          {"cabinet", made(test::box_mesh({-0.4, -0.3, 0.1}, {0.5, 0.4, 1.3}))}},
                         test::kConcrete);
    // Rounding decides which face of an edge comes first, so paths are identified by their lengths.
    std::vector<double> lengths;
    for (const Path& path : diffracted_paths(scene,
                                             transmitter_at(rotated({-1.7, 0.3, 1.8})),
                                             receiver_at(rotated({1.6, 1.2, 0.7})),
                                             over_edges(3))) {
      lengths.push_back(length_of(path));
    }
    std::sort(lengths.begin(), lengths.end());
    return lengths;
  };
  const std::vector<double> exact = paths_of(false);
  const std::vector<double> rounded = paths_of(true);
  EXPECT_GT(exact.size(), 50U);
  ASSERT_EQ(rounded.size(), exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(rounded[i], exact[i], 1e-5);
  }
}

TEST(EdgePaths, DisabledEdgesLeaveOtherPathsUnchanged) {
  const auto scene = furnished(test::kConcrete);
  const Transmitter transmitter = transmitter_at({-1.7, 0.3, 1.8});
  const Receiver receiver = receiver_at({1.6, 1.2, 0.7});
  const Paths without = PathTracer(scene, {.max_depth = 3}).trace(transmitter, receiver);
  std::vector<Path> rest;
  for (const Path& path : PathTracer(scene, over_edges(3)).trace(transmitter, receiver)) {
    if (std::none_of(path.interactions.begin(), path.interactions.end(), [](const Interaction& i) {
          return is_edge(i.kind);
        })) {
      rest.push_back(path);
    }
  }
  ASSERT_EQ(rest.size(), without.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    EXPECT_EQ(rest[i].a.re, without[i].a.re);
    EXPECT_EQ(rest[i].a.im, without[i].a.im);
    EXPECT_EQ(rest[i].tau, without[i].tau);
    EXPECT_EQ(met_by(rest[i], false), met_by(without[i], false));
  }
}

}  // namespace
}  // namespace rayloc::edge_paths_test
