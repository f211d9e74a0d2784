// Paths over two edges in a row: against moments of a strip, a plain search, and physics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/constants.h"
#include "engine/scene/wedges.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/scenes.h"
#include "tests/support/strip_moments.h"

namespace rayloc::edge_pairs_test {
namespace {

using Cd = std::complex<double>;

constexpr double kWavelength = kSpeedOfLight / test::kCarrier;  // [m]
const RadioMaterial kMetal{"metal", 1.0, 1e9, 0.002};

TraceOptions over_edges(int depth) { return {.max_depth = depth, .diffraction = true}; }
TraceOptions over_two_edges(int depth) {
  TraceOptions options = over_edges(depth);
  options.double_diffraction = true;
  return options;
}

std::size_t edges_of(const Path& path) {
  return static_cast<std::size_t>(
      std::count_if(path.interactions.begin(), path.interactions.end(), [](const Interaction& i) {
        return is_edge(i.kind);
      }));
}

double length_of(const Path& path) { return path.tau * kSpeedOfLight; }

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

// Upright in the plane y = 0, from x = 0 on; lengths in wavelengths. Its other edges are far away.
std::shared_ptr<const Scene> strip(double width) {
  return test::make_scene(
      {{"strip",
        test::rectangle_mesh(
            {0.0, 0.0, -50.0}, {width * kWavelength, 0.0, 0.0}, {0.0, 0.0, 100.0})}},
      kMetal);
}

// The field of a line source in the plane z = 0, as in StripMoments: each path, relative to a wave
// of its length, is the same for a point source and a line source.
Cd field_of_line(const PathTracer& tracer,
                 const test::StripMoments::Point& source,
                 const test::StripMoments::Point& observer) {
  Transmitter transmitter;  // both antennas upright: along the edges
  transmitter.position = {source.first * kWavelength, source.second * kWavelength, 0.0};
  Receiver receiver;
  receiver.position = {observer.first * kWavelength, observer.second * kWavelength, 0.0};
  Cd sum;
  for (const Path& path : tracer.trace(transmitter, receiver)) {
    const bool is_level =
        std::all_of(path.interactions.begin(), path.interactions.end(), [](const Interaction& i) {
          return std::abs(i.position.z) < 1.0;
        });
    if (is_level) {
      const double length = length_of(path) / kWavelength;
      const Cd relative = Cd{path.a.re, path.a.im} * (4.0 * std::numbers::pi * length);
      sum += relative * std::polar(1.0 / std::sqrt(length), -2.0 * std::numbers::pi * length);
    }
  }
  return sum;
}

// Where the way goes along the strip the second edge matters; the wave along it vanishes, so that
// all of it is slope.
TEST(EdgePairs, MatchTheMethodOfMomentsForAStrip) {
  for (const double width : {1.0, 2.0, 4.0}) {
    const PathTracer over_one(strip(width), over_edges(1));
    const PathTracer over_two(strip(width), over_two_edges(2));
    for (const auto& [source, observer, is_along] :
         {std::tuple(std::pair(0.5 * width + 0.3, 3.0), std::pair(0.5 * width - 0.2, -4.0), false),
          std::tuple(std::pair(-4.0, 2.0), std::pair(0.5 * width, -3.0), false),
          std::tuple(std::pair(0.5 * width, 5.0), std::pair(width + 3.0, -3.0), false),
          std::tuple(std::pair(-5.0, 1.0), std::pair(width + 3.7, -1.1), true),
          std::tuple(std::pair(-5.0, 0.01), std::pair(width + 4.0, -1.0), true),
          std::tuple(std::pair(-3.0, 2.0), std::pair(width + 3.0, 0.5), true)}) {
      const Cd exact = test::StripMoments(width, source).at(observer);
      const double alone = 1.0 / std::sqrt(std::hypot(source.first - observer.first,
                                                      source.second - observer.second));
      const double one = std::abs(field_of_line(over_one, source, observer) - exact) / alone;
      const double two = std::abs(field_of_line(over_two, source, observer) - exact) / alone;
      std::printf(
          "strip of %.0f wavelengths: error %.4f over one edge, %.4f over two\n", width, one, two);
      EXPECT_LT(two, width < 2.0 ? 0.12 : 0.06);
      if (is_along) {
        EXPECT_LT(two, 0.45 * one);
      } else {
        EXPECT_LT(two, 0.006);
      }
    }
  }
}

// Two sheets, one behind the other: the path over the first alone ends where the second one begins
// to hide it.
TEST(EdgePairs, ChannelIsContinuousWhereASecondEdgeBegins) {
  for (const RadioMaterial& material : {kMetal, test::kConcrete}) {
    const auto scene = test::make_scene(
        {{"first", test::rectangle_mesh({0, -60, -50}, {0, 60, 0}, {0, 0, 100})},
         {"second", test::rectangle_mesh({2, -60, -50}, {0, 60.05, 0}, {0, 0, 100})}},
        material);
    const PathTracer over_one(scene, over_edges(1));
    const PathTracer over_two(scene, over_two_edges(2));
    const Transmitter transmitter = transmitter_at({-3.0, -1.5, 0.3});
    const auto total = [&](const PathTracer& tracer, double y) {
      Cd sum;
      for (const Path& path : tracer.trace(transmitter, receiver_at({4.0, y, 1.2}))) {
        if (length_of(path) < 12.0) {  // over the upright edges
          sum += Cd{path.a.re, path.a.im} *
                 std::polar(1.0, -2.0 * std::numbers::pi * length_of(path) / kWavelength);
        }
      }
      return sum;
    };
    constexpr double kBoundary = 0.1;  // [m], in line with both edges
    constexpr double kStep = 1e-4;     // [m], more than what is looked for beside edges
    const auto jump = [&](const PathTracer& tracer) {
      return std::abs(total(tracer, kBoundary + kStep) - total(tracer, kBoundary - kStep));
    };
    const double whole = std::abs(total(over_one, kBoundary + kStep));
    EXPECT_GT(jump(over_one), 0.9 * whole);
    // The rest is due to the first edge's phase length, which ends at the second (0.015).
    EXPECT_LT(jump(over_two), 0.03 * whole) << material.name;
    std::printf("%s: jump %.4f over one edge, %.5f over two\n",
                material.name.c_str(),
                jump(over_one) / whole,
                jump(over_two) / whole);
  }
}

std::shared_ptr<const Scene> furnished(const RadioMaterial& material) {
  return test::make_scene(
      {{"room", test::box_mesh({-3, -2.5, 0}, {3, 2.5, 2.6})},
       {"table", test::box_mesh({-0.6, -0.4, 0.7}, {0.7, 0.5, 0.75})},
       {"cupboard", test::box_mesh({1.0, -1.4, 0.0}, {1.4, -0.2, 1.9})},
       {"screen", test::rectangle_mesh({-1.1, 0.6, 0.4}, {0.3, 1.0, 0}, {0, 0, 1.3})}},
      material);
}

using Key = std::vector<std::uint32_t>;

Key met_by(const Path& path) {
  Key met;
  for (const Interaction& i : path.interactions) {
    met.push_back(is_edge(i.kind) ? i.edge : 1000U + i.surface);
  }
  return met;
}

TEST(EdgePairs, EndsMayBeExchanged) {
  for (const RadioMaterial& material : {kMetal, test::kConcrete}) {
    for (const bool transmission : {false, true}) {
      const auto scene = furnished(material);
      TraceOptions options = over_two_edges(transmission ? 4 : 3);
      options.transmission = transmission;
      const Transmitter transmitter = transmitter_at({-1.7, 0.3, 1.8});
      const Receiver receiver = receiver_at({1.6, 1.2, 0.5});
      const PathTracer tracer(scene, options);
      const auto there = tracer.trace(transmitter, receiver);
      const auto back = tracer.trace(Transmitter{static_cast<const RadioDevice&>(receiver)},
                                     Receiver{static_cast<const RadioDevice&>(transmitter)});
      std::map<Key, Cd> sums_there;  // on a sheet a pair has two
      std::map<Key, Cd> sums_back;
      for (const Path& path : there) {
        sums_there[met_by(path)] += Cd{path.a.re, path.a.im};
      }
      for (const Path& path : back) {
        Key met = met_by(path);
        std::reverse(met.begin(), met.end());
        sums_back[met] += Cd{path.a.re, path.a.im};
      }
      ASSERT_EQ(sums_there.size(), sums_back.size());
      std::size_t pairs = 0;
      for (const Path& path : there) {
        pairs += edges_of(path) == 2 ? 1U : 0U;
      }
      EXPECT_GT(pairs, 20U);
      for (const auto& [met, sum] : sums_there) {
        ASSERT_EQ(sums_back.count(met), 1U);
        EXPECT_LT(std::abs(sum - sums_back.at(met)), 1e-13);
      }
    }
  }
}

// Where a convex length is least between 0 and the end, by golden sections.
template <typename Length>
double least(double end, const Length& length) {
  double low = 0.0;
  double high = end;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int i = 0; i < 90; ++i) {
    const double a = high - golden * (high - low);
    const double b = low + golden * (high - low);
    (length(a) < length(b) ? high : low) = length(a) < length(b) ? b : a;
  }
  return 0.5 * (low + high);
}

bool is_within(const Wedge& wedge, const Vec3d& point) {
  const Vec3d off = point - wedge.from;
  double azimuth = std::atan2(dot(off, wedge.normal), dot(off, wedge.in_face));
  azimuth += azimuth < -1e-9 ? 2.0 * std::numbers::pi : 0.0;
  return azimuth > wedge.n * std::numbers::pi + 1e-9;
}

Vec3d beside(const Wedge& wedge, const Vec3d& at) {
  const double middle = 0.5 * wedge.n * std::numbers::pi;
  return at + 2e-5 * (std::cos(middle) * wedge.in_face + std::sin(middle) * wedge.normal);
}

// Where the way over two edges is shortest; nothing where that is at an end of one.
std::optional<std::pair<Vec3d, Vec3d>> plain_bends(const Wedge& first,
                                                   const Wedge& second,
                                                   const Vec3d& from,
                                                   const Vec3d& to) {
  constexpr double kEnd = 1e-5;  // [m]
  const double first_end = norm(first.to - first.from);
  const double second_end = norm(second.to - second.from);
  const auto at = [](const Wedge& wedge, double height) {
    return wedge.from + height * wedge.along;
  };
  const auto best_second = [&](double height) {
    const Vec3d bend = at(first, height);
    return least(second_end, [&](double other) {
      return norm(at(second, other) - bend) + norm(to - at(second, other));
    });
  };
  const double height = least(first_end, [&](double one) {
    const Vec3d bend = at(first, one);
    const Vec3d other = at(second, best_second(one));
    return norm(bend - from) + norm(other - bend) + norm(to - other);
  });
  const double other = best_second(height);
  if (height < kEnd || height > first_end - kEnd || other < kEnd || other > second_end - kEnd) {
    return std::nullopt;
  }
  return std::pair(at(first, height), at(second, other));
}

// Every pair of edges, and whether the way over them is free.
std::set<Key> plain_search(const Scene& scene, const Vec3d& from, const Vec3d& to) {
  const std::vector<Wedge> wedges = find_wedges(scene);
  std::set<Key> found;
  for (std::uint32_t a = 0; a < wedges.size(); ++a) {
    for (std::uint32_t b = 0; b < wedges.size(); ++b) {
      const Wedge& first = wedges[a];
      const Wedge& second = wedges[b];
      if (a == b || is_within(first, from) || is_within(second, to)) {
        continue;
      }
      const auto bends = plain_bends(first, second, from, to);
      if (!bends || is_within(first, bends->second) || is_within(second, bends->first)) {
        continue;
      }
      const Vec3d bend = beside(first, bends->first);
      const Vec3d other = beside(second, bends->second);
      const bool is_joined = first.face_0 == second.face_0 || first.face_0 == second.face_n ||
                             first.face_n == second.face_0 || first.face_n == second.face_n;
      // Along a face, only objects on it can block the way, and there are none.
      if (!scene.is_blocked({from, bend}) && !scene.is_blocked({other, to}) &&
          (is_joined || !scene.is_blocked({bend, other}))) {
        found.insert({a, b});
      }
    }
  }
  return found;
}

TEST(EdgePairs, NoneIsMissedAndNoneInvented) {
  const auto scene = furnished(test::kConcrete);
  for (const auto& [from, to] : {std::pair(Vec3d{-1.7, 0.3, 1.8}, Vec3d{1.6, 1.2, 0.5}),
                                 std::pair(Vec3d{-0.9, -1.2, 0.6}, Vec3d{2.1, -0.4, 1.7})}) {
    std::set<Key> found;
    std::size_t along_sheets = 0;
    for (const Path& path :
         PathTracer(scene, over_two_edges(2)).trace(transmitter_at(from), receiver_at(to))) {
      if (edges_of(path) == 2) {
        along_sheets += found.insert(met_by(path)).second ? 0U : 1U;
      }
    }
    EXPECT_EQ(found, plain_search(*scene, from, to));
    EXPECT_GT(found.size(), 8U);
    std::printf("%zu pairs, %zu of them on both sides of a sheet\n", found.size(), along_sheets);
  }
}

TEST(EdgePairs, AreThereOnlyWhereTheyAreWanted) {
  const auto scene = furnished(test::kConcrete);
  const Transmitter transmitter = transmitter_at({-1.7, 0.3, 1.8});
  const Receiver receiver = receiver_at({1.6, 1.2, 0.5});
  const auto most_edges = [&](const TraceOptions& options) {
    std::size_t most = 0;
    for (const Path& path : PathTracer(scene, options).trace(transmitter, receiver)) {
      most = std::max(most, edges_of(path));
    }
    return most;
  };
  EXPECT_EQ(most_edges(over_edges(3)), 1U);
  EXPECT_EQ(most_edges(over_two_edges(1)), 1U);
  EXPECT_EQ(most_edges(over_two_edges(2)), 2U);
}

}  // namespace
}  // namespace rayloc::edge_pairs_test
