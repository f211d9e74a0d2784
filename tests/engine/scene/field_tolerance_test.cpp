// Tolerances for one plane, one line or one place do not depend on a room's rotation, its place,
// the precision of its file's vertices or the number of triangles that it is cut into.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "engine/scene/moved_surfaces.h"
#include "engine/scene/read/load_scene.h"
#include "engine/scene/surface.h"
#include "tests/support/read_meshes.h"
#include "tests/support/rotated_walls.h"
#include "tests/support/scenes.h"

namespace rayloc::field_tolerance_test {
namespace {

double nearest(const std::vector<Vec3d>& corners, const Vec3d& point) {
  double least = 1e9;
  for (const Vec3d& corner : corners) {
    least = std::min(least, norm(corner - point));
  }
  return least;
}

double inside_distance(const Surface& surface, const Vec3d& point) {
  const Vec3d from = point - surface.origin();
  return surface.inside_distance(dot(surface.u_axis(), from), dot(surface.v_axis(), from));
}

TEST(Field, WallOfFloatsIsOneMirrorHoweverFineAndFar) {
  std::mt19937_64 random(32);
  std::uniform_real_distribution<double> side(0.5, 12.0);
  std::uniform_int_distribution<std::uint32_t> parts(1, 12);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3d size{side(random), side(random), 0.0};
    const test::RigidMotion motion = test::random_motion(random, trial % 2 == 0 ? 20.0 : 500.0);
    const Mesh wall = test::rectangle_mesh({0, 0, 0}, {size.x, 0, 0}, {0, size.y, 0});
    const Mesh mesh = test::rounded_to_float(motion(test::subdivided(wall, parts(random))));
    const auto surfaces = planar_surfaces(mesh);
    ASSERT_EQ(surfaces.size(), 1U) << trial;
    const Surface& surface = surfaces[0].surface;
    EXPECT_TRUE(surfaces[0].one_facing);
    EXPECT_EQ(surface.pieces().size(), 1U) << trial;
    EXPECT_EQ(surface.outline().size(), 4U) << trial;
    for (const Vec3d& corner : wall.vertices) {
      EXPECT_LE(nearest(surface.outline(), motion(corner)), 8.0 * mesh.rounding) << trial;
    }
  }
}

// Slivers of a millimetre, whose own normals rounding tilts by degrees.
TEST(Field, SliversOfAWallOfFloatsBelongToIt) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 100; ++trial) {
    Mesh mesh;
    for (std::uint32_t i = 0; i <= 40; ++i) {
      // Wide and narrow strips in turn.
      const bool is_narrow = i % 2 == 1;
      const double x = 0.05 * (is_narrow ? i - 1 : i) + (is_narrow ? 1e-3 : 0.0);
      mesh.vertices.push_back({x, 0, 0});
      mesh.vertices.push_back({x, 2.5, 0});
      if (i > 0) {
        mesh.triangles.push_back({2 * i - 2, 2 * i, 2 * i + 1});
        mesh.triangles.push_back({2 * i - 2, 2 * i + 1, 2 * i - 1});
      }
    }
    const auto surfaces =
        planar_surfaces(test::rounded_to_float(test::random_motion(random, 60.0)(mesh)));
    ASSERT_EQ(surfaces.size(), 1U) << trial;
    EXPECT_TRUE(surfaces[0].one_facing) << trial;
  }
}

TEST(Field, FacesAMillimetreApartStayTwoFarFromTheOrigin) {
  std::mt19937_64 random(6);
  for (const double reach : {10.0, 1000.0, 90'000.0}) {
    Mesh mesh = test::rectangle_mesh({0, 0, 0}, {3, 0, 0}, {0, 2, 0});
    const Mesh other = test::rectangle_mesh({0, 0, 1e-3}, {3, 0, 0}, {0, 2, 0});
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    mesh.triangles.push_back({4, 5, 6});
    mesh.triangles.push_back({4, 6, 7});
    EXPECT_EQ(planar_surfaces(test::random_motion(random, reach)(mesh)).size(), 2U) << reach;
  }
}

// A wall about a door, of three rectangles that do not share corners.
TEST(Field, SidesThatMeetWithoutSharedCornersAreNoBoundary) {
  const Mesh left = test::rectangle_mesh({0, 0, 0}, {1, 0, 0}, {0, 0, 2.5});
  const Mesh lintel = test::rectangle_mesh({1, 0, 2}, {0.9, 0, 0}, {0, 0, 0.5});
  const Mesh right = test::rectangle_mesh({1.9, 0, 0}, {2.1, 0, 0}, {0, 0, 2.5});
  Mesh wall;
  for (const Mesh& part : {left, lintel, right}) {
    const auto first = static_cast<std::uint32_t>(wall.vertices.size());
    wall.vertices.insert(wall.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles) {
      wall.triangles.push_back({first + a, first + b, first + c});
    }
  }
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const test::RigidMotion motion = test::random_motion(random, trial == 0 ? 0.0 : 100.0);
    const bool floats = trial % 2 == 1;
    const Mesh mesh = floats ? test::rounded_to_float(motion(wall)) : motion(wall);
    const auto surfaces = planar_surfaces(mesh);
    ASSERT_EQ(surfaces.size(), 1U);
    const Surface& surface = surfaces[0].surface;
    ASSERT_FALSE(surface.is_convex());
    const double rounding = floats ? 8.0 * mesh.rounding : 1e-9;
    const auto expect = [&](const Vec3d& point, double inside) {
      EXPECT_NEAR(inside_distance(surface, motion(point)), inside, rounding) << trial;
    };
    expect({1.0, 0, 2.25}, 0.25);  // on the seam beside the lintel
    expect({1.9, 0, 2.3}, 0.2);
    expect({1.2, 0, 2.3}, 0.2);
    expect({0.9, 0, 1.0}, 0.1);
    expect({1.45, 0, 1.0}, -0.45);
    expect({3.0, 0, 1.2}, 1.0);
    // Nothing goes through a seam.
    for (double z = 2.01; z < 2.5; z += 0.013) {
      EXPECT_TRUE(surface.contains(motion({1.0, 0, z}))) << trial;
      EXPECT_TRUE(surface.contains(motion({1.9, 0, z}))) << trial;
    }
  }
}

TEST(Field, SheetOfTwoFacesHasItsEdges) {
  Mesh mesh = test::rectangle_mesh({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  mesh.triangles.push_back({0, 2, 1});
  mesh.triangles.push_back({0, 3, 2});
  const auto surfaces = planar_surfaces(mesh);
  ASSERT_EQ(surfaces.size(), 1U);
  EXPECT_TRUE(surfaces[0].surface.is_convex());
  EXPECT_NEAR(surfaces[0].surface.area(), 1.0, 1e-15);
  // And so has one with a hole, whose faces are cut in different ways.
  const std::vector<Mesh> parts{test::rectangle_mesh({0, 0, 0}, {3, 0, 0}, {0, 1, 0}),
                                test::rectangle_mesh({0, 1, 0}, {1, 0, 0}, {0, 1, 0}),
                                test::rectangle_mesh({2, 1, 0}, {1, 0, 0}, {0, 1, 0}),
                                test::rectangle_mesh({0, 2, 0}, {3, 0, 0}, {0, 1, 0})};
  Mesh frame;
  for (const bool behind : {false, true}) {
    for (const Mesh& part : parts) {
      const auto first = static_cast<std::uint32_t>(frame.vertices.size());
      frame.vertices.insert(frame.vertices.end(), part.vertices.begin(), part.vertices.end());
      if (behind) {
        frame.triangles.push_back({first, first + 3, first + 1});
        frame.triangles.push_back({first + 1, first + 3, first + 2});
      } else {
        frame.triangles.push_back({first, first + 1, first + 2});
        frame.triangles.push_back({first, first + 2, first + 3});
      }
    }
  }
  const auto framed = planar_surfaces(frame);
  ASSERT_EQ(framed.size(), 1U);
  EXPECT_NEAR(inside_distance(framed[0].surface, {0.6, 1.5, 0}), 0.4, 1e-12);
  EXPECT_NEAR(inside_distance(framed[0].surface, {0.5, 0.9, 0}), 0.5, 1e-12);
  EXPECT_NEAR(inside_distance(framed[0].surface, {1.5, 1.5, 0}), -0.5, 1e-12);
}

TEST(Field, FacesOfABoxOfFloatsFarAwayMoveByTheirOffsets) {
  std::mt19937_64 random(9);
  Mesh box = test::rounded_to_float(
      test::random_motion(random, 400.0)(test::box_mesh({0, 0, 0}, {1, 2, 3})));
  const auto scene = test::make_scene({{"box", box}}, test::kConcrete);
  ASSERT_EQ(scene->surfaces().size(), 6U);
  const std::vector<double> offset(6, 0.01);
  const auto moved = move_surfaces(*scene, offset);
  ASSERT_TRUE(moved) << moved.error().message;
  for (std::size_t i = 0; i < offset.size(); ++i) {
    const Surface& before = scene->surfaces()[i];
    const Surface& after = moved->surfaces()[i];
    EXPECT_NEAR(distance(after.plane(), before.outline()[0]), -0.01, 16.0 * box.rounding);
  }
}

std::string binary_ply(const std::vector<Vec3d>& vertices, bool doubles) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(vertices.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) {
    bytes += std::string("property ") + (doubles ? "double " : "float ") + axis + "\n";
  }
  bytes += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto append = [&](const auto& value) {
    std::string raw(sizeof(value), '\0');
    std::memcpy(raw.data(), &value, sizeof(value));
    bytes += raw;
  };
  for (const Vec3d& v : vertices) {
    for (const double x : {v.x, v.y, v.z}) {
      if (doubles) {
        append(x);
      } else {
        append(static_cast<float>(x));
      }
    }
  }
  append(static_cast<std::uint8_t>(vertices.size()));
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(vertices.size()); ++i) {
    append(i);
  }
  return bytes;
}

std::string scene_error(const std::string& mesh, const std::string& transform) {
  const std::string xml =
      "<scene version='3.0.0'><bsdf type='diffuse' id='mat-itu_concrete'/><shape type='ply' "
      "id='mesh-floor'><string name='filename' value='floor.ply'/><transform name='to_world'>" +
      transform + "</transform><ref id='mat-itu_concrete'/></shape></scene>";
  const auto scene =
      parse_scene(xml, "scene.xml", {5.18e9, {}}, [&](const std::string&) { return mesh; });
  return scene ? "no error" : scene.error().message;
}

TEST(Field, RoomAtMapCoordinatesGetsATranslation) {
  const std::vector<Vec3d> floor{{691000, 5334000, 520.25},
                                 {691004, 5334000, 520.25},
                                 {691004, 5334003, 520.25},
                                 {691000, 5334003, 520.25}};
  const std::string doubles = binary_ply(floor, true);
  EXPECT_EQ(scene_error(doubles, ""),
            "scene.xml: object 'floor': vertex 0 is at 691000, 5334000, 520, further than 100 km "
            "from the origin; coordinates of a map must be made local: add <translate "
            "x=\"-691000\" y=\"-5334000\" z=\"0\"/> at the end of every <transform "
            "name=\"to_world\">, and shift the site's places alike");
  EXPECT_EQ(scene_error(doubles, "<translate x='-691000' y='-5334000' z='0'/>"), "no error");
  // Floats have lost the room before anybody could move it.
  const std::string message =
      scene_error(binary_ply(floor, false), "<translate x='-691000' y='-5334000' z='0'/>");
  EXPECT_NE(message.find("floor.ply: byte "), std::string::npos) << message;
  EXPECT_NE(message.find("a coordinate of vertex 0 is 5334000 m, of which a float keeps no "
                         "millimetres; export the mesh about a local origin"),
            std::string::npos)
      << message;
}

TEST(Field, MeshHasTheRoundingOfItsFile) {
  const std::vector<Vec3d> floor{{300, 0, 0}, {304, 0, 0}, {304, 3, 0}};
  const auto floats = read_ply(binary_ply(floor, false), "a.ply");
  const auto doubles = read_ply(binary_ply(floor, true), "a.ply");
  ASSERT_TRUE(floats && doubles);
  EXPECT_EQ(floats->rounding, 0x1p-24 * 304.0);
  EXPECT_EQ(doubles->rounding, 0.0);
}

// Numbers as a stream of C++ writes them by default.
TEST(Field, WallWrittenWithSixDigitsIsOneMirror) {
  std::mt19937_64 random(66);
  for (int trial = 0; trial < 100; ++trial) {
    const Mesh wall = test::random_motion(random, 60.0)(
        test::subdivided(test::rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 2.5, 0}), 10));
    std::ostringstream ply;
    std::ostringstream obj;
    ply << "ply\nformat ascii 1.0\nelement vertex " << wall.vertices.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
        << wall.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3d& v : wall.vertices) {
      ply << v.x << ' ' << v.y << ' ' << v.z << '\n';
      obj << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    }
    for (const auto& [a, b, c] : wall.triangles) {
      ply << "3 " << a << ' ' << b << ' ' << c << '\n';
      obj << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
    }
    for (const auto& mesh : {read_ply(ply.str(), "a.ply"), read_obj(obj.str(), "a.obj")}) {
      ASSERT_TRUE(mesh) << mesh.error().message;
      const auto surfaces = planar_surfaces(*mesh);
      ASSERT_EQ(surfaces.size(), 1U) << trial;
      EXPECT_TRUE(surfaces[0].surface.is_convex()) << trial;
      EXPECT_NEAR(surfaces[0].surface.area(), 10.0, 0.01) << trial;
    }
  }
}

TEST(Field, RoundNumbersOfATextFileAreExact) {
  const auto rounding_of = [](const std::string& vertices) {
    const auto mesh = read_obj(vertices + "f 1 2 3\n", "a.obj");
    EXPECT_TRUE(mesh);
    return mesh ? mesh->rounding : -1.0;
  };
  EXPECT_EQ(rounding_of("v 0 0 0\nv 12.34 0 0\nv 0 0.0025 0\n"), 0.0);
  EXPECT_NEAR(rounding_of("v 0 0 0\nv 12.3457 0 0\nv 0 1.5 0\n"), 5e-5, 1e-18);
  EXPECT_NEAR(rounding_of("v 0 0 0\nv 2.345678 0 0\nv 0 1.5e0 0\n"), 5e-7, 1e-18);
  EXPECT_NEAR(rounding_of("v 0 0 0\nv 1.234567890123e1 0 0\nv 0 1 0\n"), 5e-12, 1e-20);
  EXPECT_NEAR(rounding_of("v 0 0 0\nv 9000.25 0 0\nv 0 1 0\n"), 5e-5, 1e-18);
}

}  // namespace
}  // namespace rayloc::field_tolerance_test
