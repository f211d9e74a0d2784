// Faces of two objects in one plane: with transmission the channel is that of a gap which goes to
// zero.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "engine/trace/coplanar_faces.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/rotated_walls.h"
#include "tests/support/scenes.h"

namespace rayloc::field_coplanar_test {
namespace {

constexpr double kGap = 5e-6;  // [m], 0.03 degrees of the carrier

struct Piece {
  Mesh mesh;
  RadioMaterial material;
  Vec3d apart;  // where it goes as the gap opens, for a gap of 1 m
};

const RadioMaterial kPlaster{"plaster", 2.5, 0.01, 0.03};
const RadioMaterial kBrick{"brick", 5.0, 0.05, 0.1};

std::shared_ptr<const Scene> scene_of(const std::vector<Piece>& pieces,
                                      const test::RigidMotion& motion,
                                      double gap) {
  Scene::Input input;
  input.carrier_hz = test::kCarrier;
  for (const Piece& piece : pieces) {
    const test::RigidMotion open{{}, gap * piece.apart};
    input.objects.push_back({piece.material.name + std::to_string(input.objects.size()),
                             motion(open(piece.mesh)),
                             static_cast<std::uint32_t>(input.materials.size())});
    input.materials.push_back(piece.material);
  }
  auto scene = Scene::create(std::move(input));
  EXPECT_TRUE(scene) << scene.error().message;
  return std::make_shared<const Scene>(std::move(*scene));
}

// The channel at the carrier.
std::complex<double> channel(const Paths& paths) {
  std::complex<double> h;
  for (const Path& path : paths) {
    h += std::complex<double>(path.a.re, path.a.im) *
         std::polar(1.0, -2.0 * std::numbers::pi * std::fmod(test::kCarrier * path.tau, 1.0));
  }
  return h;
}

void expect_no_jump(const std::vector<Piece>& pieces,
                    const std::vector<Vec3d>& places,
                    const TraceOptions& options) {
  std::mt19937_64 random(4);
  for (const double reach : {0.0, 30.0}) {
    const test::RigidMotion motion =
        reach == 0.0 ? test::RigidMotion{} : test::random_motion(random, reach);
    const PathTracer closed(scene_of(pieces, motion, 0.0), options);
    const PathTracer open(scene_of(pieces, motion, kGap), options);
    for (const Vec3d& from : places) {
      for (const Vec3d& to : places) {
        const Transmitter tx{{motion(from + Vec3d{0.31, 0.17, 0.05}), {}}};
        const Receiver rx{{motion(to), {}}};
        const Paths without = closed.trace(tx, rx);
        const Paths with = open.trace(tx, rx);
        ASSERT_EQ(without.size(), with.size()) << reach;
        ASSERT_GT(with.size(), 0U);
        EXPECT_LT(std::abs(channel(without) - channel(with)), 5e-3 * std::abs(channel(with)))
            << "from " << from.x << ", " << from.z << " to " << to.x << ", " << to.z;
      }
    }
  }
}

TEST(Field, CoplanarSheetsAreTheLimitOfAGap) {
  const Mesh wall = test::rectangle_mesh({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  const Mesh board = test::rectangle_mesh({-1, -1.5, 0}, {2, 0, 0}, {0, 3, 0});
  // The first lies where its normal points to.
  for (const bool board_first : {false, true}) {
    std::vector<Piece> pieces{{wall, kBrick, {0, 0, 1}}, {board, kPlaster, {}}};
    if (board_first) {
      pieces = {{board, kPlaster, {0, 0, 1}}, {wall, kBrick, {}}};
    }
    expect_no_jump(pieces,
                   {{0.2, 0.1, 0.7}, {-0.6, 0.3, 1.2}, {0.1, -0.2, -0.9}, {1.4, 1.1, 0.5}},
                   {.max_depth = 5, .transmission = true});
  }
}

TEST(Field, ObjectOnTheFloorIsTheLimitOfAGap) {
  const Mesh slab = test::box_mesh({-3, -3, -0.2}, {3, 3, 0});
  const Mesh thing = test::box_mesh({-0.5, -0.5, 0}, {0.5, 0.5, 1.2});
  for (const bool thing_first : {false, true}) {
    std::vector<Piece> pieces{{slab, kBrick, {}}, {thing, kPlaster, {0, 0, 1}}};
    if (thing_first) {
      std::swap(pieces[0], pieces[1]);
    }
    expect_no_jump(pieces,
                   {{0.05, 0.02, 0.4}, {-1.2, 0.3, 1.1}, {0.1, 0.03, -0.1}, {0.37, 0.13, 1.67}},
                   {.max_depth = 5, .transmission = true});
  }
}

TEST(Field, ThingWithinTheShellOfARoomIsTheLimitOfAGap) {
  const Mesh shell = test::box_mesh({-3, -3, 0}, {3, 3, 2.5});
  const Mesh thing = test::box_mesh({-0.5, -0.5, 0}, {0.5, 0.5, 1.2});
  for (const bool thing_first : {false, true}) {
    std::vector<Piece> pieces{{shell, kBrick, {}}, {thing, kPlaster, {0, 0, 1}}};
    if (thing_first) {
      std::swap(pieces[0], pieces[1]);
    }
    expect_no_jump(pieces,
                   {{0.05, 0.02, 0.4}, {-1.2, 0.3, 1.1}, {0.37, 0.13, 1.67}},
                   {.max_depth = 5, .transmission = true});
  }
}

TEST(Field, CoplanarFacesAreKnownFarFromTheOrigin) {
  // Vertices 80 km away are rounded to 15 pm, which tilts planes by more than nothing.
  const Mesh wall = test::rectangle_mesh({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  const Mesh board = test::rectangle_mesh({-1, -1.5, 0}, {2, 0, 0}, {0, 3, 0});
  std::mt19937_64 random(8);
  for (int trial = 0; trial < 50; ++trial) {
    test::RigidMotion motion = test::random_motion(random, 1.0);
    motion.shift = {80'000.0, -60'000.0, 500.0};
    const auto scene = scene_of({{wall, kBrick, {}}, {board, kPlaster, {}}}, motion, 0.0);
    const auto found = find_coplanar_faces(*scene, {});
    ASSERT_EQ(found.size(), 2U);
    ASSERT_EQ(found[0].size(), 1U) << trial;
    EXPECT_EQ(found[0][0].surface, 1U);
    EXPECT_EQ(found[1][0].side, 1);
    EXPECT_EQ(found[0][0].side, -1);
  }
}

}  // namespace
}  // namespace rayloc::field_coplanar_test
