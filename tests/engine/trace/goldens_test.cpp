// The tracer against independently computed paths (tests/data/goldens/README.md), to the tolerances
// stated there.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/base/constants.h"
#include "engine/scene/read/load_scene.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/golden.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::goldens_test {
namespace {

using nlohmann::json;
using test::vec3;

// Tolerances of the values; those of the furnished rooms are written with 12 digits.
constexpr double kLengthTolerance = 1e-12;  // relative
constexpr double kVertexTolerance = 1e-9;   // [m]
constexpr double kAngleTolerance = 1e-10;   // [rad]
constexpr double kFieldTolerance = 1e-10;   // of free space
constexpr double kMirrorTolerance = 1e-12;  // of free space, perfect reflectors
constexpr double kCfrTolerance = 1e-8;      // of the largest

Orientation orientation(const json& v) { return {v.at(0), v.at(1), v.at(2)}; }
AntennaPattern pattern(const json& v) { return *parse_antenna_pattern(v.get<std::string>()); }
Polarization polarization(const json& v) {
  return v == "V" ? Polarization::kVertical : Polarization::kHorizontal;
}

// The objects that a path touches, in order.
std::vector<std::string> objects_of(const Scene& scene, const Path& path) {
  std::vector<std::string> names;
  for (const Interaction& interaction : path.interactions) {
    names.push_back(scene.objects()[interaction.object].name);
  }
  return names;
}

bool same_vertices(const Path& path, const json& vertices) {
  if (vertices.size() != path.interactions.size()) {
    return false;
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (norm(path.interactions[i].position - vec3(vertices[i])) > kVertexTolerance) {
      return false;
    }
  }
  return true;
}

double angle_difference(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

// A point of this path lies on faces of two objects at once; which of them acts is undefined.
bool is_coincident(const json& path) { return path.value("coincident", false); }

// The common data of all paths of a comparison.
struct Link {
  double carrier_hz;
  double field_tolerance;
};

void expect_same_path(const Path& path, const json& expected, const Link& link) {
  const double tau = expected.at("tau");
  EXPECT_NEAR(path.tau, tau, kLengthTolerance * tau);
  if (!is_coincident(expected)) {
    const double free_space = 1.0 / (4.0 * std::numbers::pi * link.carrier_hz * tau);
    const std::complex<double> a{expected.at("a").at(0), expected.at("a").at(1)};
    EXPECT_LE(std::abs(std::complex<double>(path.a.re, path.a.im) - a),
              link.field_tolerance * free_space);
  }
  const std::array<double, 4> angles{path.theta_t(), path.phi_t(), path.theta_r(), path.phi_r()};
  for (std::size_t i = 0; i < angles.size(); ++i) {
    EXPECT_LE(angle_difference(angles[i], expected.at("angles").at(i)), kAngleTolerance);
  }
}

// Every expected path is there, once, and nothing else.
template <typename SameSurfaces>
void expect_same_paths(const Paths& paths,
                       const json& expected,
                       const Link& link,
                       SameSurfaces same_surfaces) {
  EXPECT_EQ(paths.size(), expected.size());
  std::vector<bool> used(paths.size(), false);
  for (const json& wanted : expected) {
    bool found = false;
    for (std::size_t i = 0; i < paths.size() && !found; ++i) {
      found = !used[i] && same_vertices(paths[i], wanted.at("vertices")) &&
              same_surfaces(paths[i], wanted);
      if (found) {
        used[i] = true;
        expect_same_path(paths[i], wanted, link);
      }
    }
    EXPECT_TRUE(found) << "missed: " << wanted.dump();
  }
  for (std::size_t i = 0; i < paths.size(); ++i) {
    EXPECT_TRUE(used[i]) << "invented: path " << i << " with " << paths[i].interactions.size()
                         << " reflections, tau " << paths[i].tau;
  }
}

// Walls 0..5 = -x +x -y +y -z +z.
std::size_t wall_number(const Scene& scene, const Interaction& interaction) {
  const Vec3d outwards = scene.surfaces()[interaction.surface].plane().normal;
  const std::array<double, 3> n{outwards.x, outwards.y, outwards.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(n[axis]) > 0.5) {
      return 2 * axis + (n[axis] > 0.0 ? 1 : 0);
    }
  }
  return 6;
}

// Checks one element of a room case: paths by order, and the channel on a few or all of its tones.
void expect_same_counts_and_tones(const Paths& paths, const json& element, double carrier_hz) {
  std::vector<std::size_t> counts(element.at("counts").size());
  for (const Path& path : paths) {
    ++counts.at(path.interactions.size());
  }
  EXPECT_EQ(json(counts), element.at("counts"));
  OfdmGrid grid{carrier_hz, 312'500.0, {}};
  for (std::int16_t k = -64; k < 64; ++k) {
    grid.tone_index.push_back(k);
  }
  const auto h = paths.cfr(grid);
  double largest = 0.0;
  for (const auto& value : h) {
    largest = std::max(largest, std::abs(value));
  }
  const auto expect_near = [&](std::size_t j, const json& expected) {
    const std::complex<double> wanted{expected.at(0), expected.at(1)};
    EXPECT_LE(std::abs(h[j] - wanted), kCfrTolerance * largest) << "tone " << j;
  };
  expect_near(0, element.at("h_first_subcarrier"));
  expect_near(64, element.at("h_fc"));
  expect_near(127, element.at("h_last_subcarrier"));
  for (std::size_t j = 0; element.contains("h") && j < h.size(); ++j) {
    expect_near(j, element.at("h").at(j));
  }
}

TEST(Goldens, RoomCasesMatchToTheLastDigits) {
  const json doc = test::golden("room_cases");
  const double carrier = doc.at("frequency");
  std::size_t compared = 0;
  for (const auto& [name, c] : doc.at("cases").items()) {
    SCOPED_TRACE(name);
    const RadioMaterial material{"wall", c.at("eps_r"), c.at("sigma"), c.at("thickness")};
    const auto scene = test::make_scene(
        {{"room", test::box_mesh(vec3(c.at("lo")), vec3(c.at("hi")))}}, material, carrier);
    const PathTracer tracer(scene, {.max_depth = c.at("depth")});
    const Transmitter transmitter{{vec3(c.at("tx")),
                                   orientation(c.at("tx_orientation")),
                                   pattern(c.at("pattern").at(0)),
                                   polarization(c.at("polarization").at(0))}};
    const Link link{carrier, name == "box_metal" ? kMirrorTolerance : kFieldTolerance};
    for (const json& element : c.at("elements")) {
      const Receiver receiver{{vec3(element.at("position")),
                               orientation(c.at("rx_orientation")),
                               pattern(c.at("pattern").at(1)),
                               polarization(c.at("polarization").at(1))}};
      const Paths paths = tracer.trace(transmitter, receiver);
      expect_same_counts_and_tones(paths, element, carrier);
      if (!element.contains("paths")) {
        continue;
      }
      expect_same_paths(
          paths, element.at("paths"), link, [&](const Path& path, const json& wanted) {
            for (std::size_t i = 0; i < path.interactions.size(); ++i) {
              if (wall_number(*scene, path.interactions[i]) != wanted.at("seq").at(i)) {
                return false;
              }
            }
            return true;
          });
      compared += paths.size();
    }
  }
  EXPECT_GT(compared, 400U);
}

TEST(Goldens, ShoeboxHasAsManyPathsAsImages) {
  const auto scene =
      test::make_scene({{"room", test::box_mesh({-5, -5, 0}, {5, 5, 5})}}, test::kConcrete);
  const Transmitter transmitter{{{-3.1, 1.2, 2.2}, {}}};
  const Receiver receiver{{{2.7, -0.9, 1.3}, {}}};
  const std::array<std::size_t, 6> counts{1, 6, 18, 38, 66, 102};
  std::size_t total = 0;
  for (std::size_t depth = 0; depth < counts.size(); ++depth) {
    total += counts[depth];
    EXPECT_EQ(PathTracer(scene, {.max_depth = static_cast<int>(depth)})
                  .trace(transmitter, receiver)
                  .size(),
              total)
        << "up to order " << depth;
  }
}

std::string kinds_of(const Path& path) {
  std::string kinds;
  for (const Interaction& interaction : path.interactions) {
    kinds += letter_of(interaction.kind);
  }
  return kinds;
}

// The channel over all paths.
void expect_same_cfr(const Paths& paths, const json& expected, OfdmGrid grid) {
  grid.tone_index.clear();
  for (std::size_t j = 0; j < expected.size(); ++j) {
    grid.tone_index.push_back(static_cast<std::int16_t>(j));
  }
  const auto h = paths.cfr(grid);
  double largest = 0.0;
  double worst = 0.0;
  for (std::size_t j = 0; j < h.size(); ++j) {
    const std::complex<double> wanted{expected.at(j).at(0), expected.at(j).at(1)};
    largest = std::max(largest, std::abs(wanted));
    worst = std::max(worst, std::abs(h[j] - wanted));
  }
  EXPECT_LE(worst, kCfrTolerance * largest);
}

void expect_furnished_room(const std::string& name,
                           const std::string& scene_file,
                           const TraceOptions& trace_options) {
  const json doc = test::golden(name);
  const double carrier = doc.at("frequency");
  SceneOptions options;
  options.carrier_hz = carrier;
  auto loaded = load_scene(test::data_path() + scene_file, options);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto scene = std::make_shared<const Scene>(std::move(*loaded));
  const PathTracer tracer(scene, trace_options);
  const json& offsets = doc.at("subcarrier_offsets");
  std::size_t compared = 0;
  std::size_t excepted = 0;
  for (const json& link : doc.at("links")) {
    SCOPED_TRACE("receiver " + link.at("rx").dump() + ", element " + link.at("tx_element").dump());
    const json& t = doc.at("transmitter");
    const Transmitter transmitter{
        {vec3(t.at("elements").at(link.at("tx_element").get<std::size_t>())),
         orientation(t.at("orientation"))}};
    const Receiver receiver{{vec3(doc.at("receivers").at(link.at("rx").get<std::size_t>())), {}}};
    const Paths paths = tracer.trace(transmitter, receiver);
    expect_same_paths(
        paths,
        link.at("paths"),
        {carrier, kFieldTolerance},
        [&](const Path& path, const json& wanted) {
          return kinds_of(path) == wanted.at("kinds").get<std::string>() &&
                 (is_coincident(wanted) ||
                  objects_of(*scene, path) == wanted.at("objects").get<std::vector<std::string>>());
        });
    const auto coincident = static_cast<std::size_t>(
        std::count_if(link.at("paths").begin(), link.at("paths").end(), is_coincident));
    excepted += coincident;
    if (coincident == 0) {
      expect_same_cfr(paths,
                      link.at("cfr"),
                      {carrier + offsets.at(0).get<double>(), offsets.at(1).get<double>(), {}});
    }
    compared += paths.size();
  }
  EXPECT_EQ(compared, doc.at("paths").get<std::size_t>());
  EXPECT_EQ(excepted, trace_options.transmission ? 5U : 0U);  // tests/data/goldens/README.md
}

TEST(Goldens, MeetingRoomMissesAndInventsNoPath) {
  expect_furnished_room("meeting_room", "/sites/meeting_room/scene.xml", {.max_depth = 3});
}

TEST(Goldens, CorridorMissesAndInventsNoPath) {
  expect_furnished_room("corridor", "/scenes/corridor/scene.xml", {.max_depth = 3});
}

TEST(Goldens, MeetingRoomWithTransmissionMissesAndInventsNoPath) {
  expect_furnished_room("meeting_room_transmission",
                        "/sites/meeting_room/scene.xml",
                        {.max_depth = 3, .transmission = true});
}

}  // namespace
}  // namespace rayloc::goldens_test
