// Faces of any shape, as PLY and OBJ files from the field have them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "engine/scene/read/load_scene.h"
#include "engine/scene/read/triangulate.h"
#include "engine/scene/surface.h"
#include "tests/support/read_meshes.h"
#include "tests/support/rotated_walls.h"

namespace rayloc::field_faces_test {
namespace {

using Ring = std::vector<Vec3d>;  // the corners of one face

std::vector<std::uint32_t> numbers(std::size_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

Expected<Mesh> cut(const Ring& ring) {
  Mesh mesh{ring, {}};
  RAYLOC_TRY(append_triangles(numbers(ring.size()), mesh));
  return mesh;
}

std::string refusal_of(const Ring& ring) {
  const auto mesh = cut(ring);
  return mesh ? "no error" : mesh.error().message;
}

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum +=
        0.5 * norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
  }
  return sum;
}

// In how many triangles of a mesh in the plane z = 0 a point lies.
int cover(const Mesh& mesh, const Vec3d& p) {
  int count = 0;
  for (const auto& t : mesh.triangles) {
    int left = 0;
    int right = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d& a = mesh.vertices[t[i]];
      const Vec3d& b = mesh.vertices[t[(i + 1) % 3]];
      (cross(b - a, p - a).z > 0.0 ? left : right) += 1;
    }
    count += left == 3 || right == 3 ? 1 : 0;
  }
  return count;
}

// The same by the outline of the face: how often it goes round the point.
int rounds(const Ring& ring, const Vec3d& p) {
  double angle = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3d a = ring[i] - p;
    const Vec3d b = ring[(i + 1) % ring.size()] - p;
    angle += std::atan2(cross(a, b).z, dot(a, b));
  }
  return std::abs(static_cast<int>(std::lround(angle / (2.0 * std::numbers::pi))));
}

// A star with corners on its sides and, joined by an edge run there and back, a hole.
Ring random_face(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const int corners = 3 + static_cast<int>(12.0 * share(random));
  Ring ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.8 * share(random)) / corners;
    const double radius = 1.0 + 3.0 * share(random);
    ring.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0});
  }
  for (std::size_t i = ring.size(); i > 0; --i) {
    if (share(random) < 0.3) {  // on the line, up to rounding
      const Vec3d& next = ring[i % ring.size()];
      const Vec3d between = ring[i - 1] + share(random) * (next - ring[i - 1]);
      ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(i), between);
    }
  }
  if (corners > 7 && share(random) < 0.7) {
    const Vec3d door = ring.front();
    const Vec3d along = normalized(door);
    const Vec3d across{-along.y, along.x, 0.0};
    ring.push_back(door);
    for (const auto& [x, y] : {std::pair{0.2, 0.0}, {0.0, 0.2}, {-0.2, 0.0}, {0.0, -0.2}}) {
      ring.push_back(x * along - y * across);
    }
    ring.push_back(0.2 * along);
  }
  return ring;
}

TEST(Field, FaceOfAnyShapeIsCoveredOnceByItsTriangles) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(-4.0, 4.0);
  std::size_t not_convex = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Ring ring = random_face(random);
    std::rotate(ring.begin(), ring.begin() + trial % static_cast<int>(ring.size()), ring.end());
    if (trial % 2 == 1) {
      std::reverse(ring.begin(), ring.end());
    }
    const auto mesh = cut(ring);
    ASSERT_TRUE(mesh) << trial << ": " << mesh.error().message;
    not_convex += mesh->triangles.size() > 3 ? 1U : 0U;
    for (int i = 0; i < 40; ++i) {
      const Vec3d p{share(random), share(random), 0.0};
      ASSERT_EQ(cover(*mesh, p), rounds(ring, p)) << trial << " at " << p.x << ", " << p.y;
    }
    // Rotated and far away it has the same area, and its triangles face as it does.
    const test::RigidMotion motion = test::random_motion(random, 1000.0);
    Ring rotated = ring;
    std::transform(rotated.begin(), rotated.end(), rotated.begin(), motion);
    const auto away = cut(rotated);
    ASSERT_TRUE(away) << trial << ": " << away.error().message;
    ASSERT_NEAR(area(*away), area(*mesh), 1e-8) << trial;
    const Vec3d up = motion.turn * Vec3d{0, 0, trial % 2 == 1 ? -1.0 : 1.0};
    for (const auto& [a, b, c] : away->triangles) {
      ASSERT_GT(dot(up, cross(rotated[b] - rotated[a], rotated[c] - rotated[a])), 0.0) << trial;
    }
  }
  EXPECT_GT(not_convex, 1000U);
}

TEST(Field, FloorOfAnLHasNoMirrorInItsCorner) {
  Ring ring{{4, 0, 0}, {4, 2, 0}, {2, 2, 0}, {2, 4, 0}, {0, 4, 0}, {0, 0, 0}};
  for (std::size_t turn = 0; turn < ring.size(); ++turn) {
    for (const bool reversed : {false, true}) {
      Ring face = ring;
      std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(turn), face.end());
      if (reversed) {
        std::reverse(face.begin(), face.end());
      }
      const auto mesh = cut(face);
      ASSERT_TRUE(mesh) << mesh.error().message;
      EXPECT_EQ(mesh->triangles.size(), 4U);
      const auto surfaces = planar_surfaces(*mesh);
      ASSERT_EQ(surfaces.size(), 1U);
      EXPECT_FALSE(surfaces[0].surface.contains({2.5, 2.5, 0.0}));
      EXPECT_TRUE(surfaces[0].surface.contains({1.0, 3.0, 0.0}));
      EXPECT_TRUE(surfaces[0].surface.contains({3.0, 1.0, 0.0}));
      EXPECT_NEAR(surfaces[0].surface.area(), 12.0, 1e-12);
    }
  }
}

TEST(Field, DoorwayByAKeyholeEdgeStaysOpen) {
  // A wall of 5 x 3 m with a window, joined by an edge to a corner, and a door, which is a step of
  // the outline.
  const Ring wall{{0, 0, 0},
                  {1, 0, 0},
                  {1, 0, 2},
                  {2, 0, 2},
                  {2, 0, 0},
                  {5, 0, 0},
                  {5, 0, 3},
                  {4, 0, 2},
                  {4, 0, 1},
                  {3, 0, 1},
                  {3, 0, 2},
                  {4, 0, 2},
                  {5, 0, 3},
                  {0, 0, 3}};
  for (const bool reversed : {false, true}) {
    Ring face = wall;
    if (reversed) {
      std::reverse(face.begin(), face.end());
    }
    const auto mesh = cut(face);
    ASSERT_TRUE(mesh) << mesh.error().message;
    const auto surfaces = planar_surfaces(*mesh);
    ASSERT_EQ(surfaces.size(), 1U);
    const Surface& surface = surfaces[0].surface;
    EXPECT_NEAR(surface.area(), 15.0 - 2.0 - 1.0, 1e-12);
    EXPECT_FALSE(surface.contains({1.5, 0.0, 1.0}));
    EXPECT_FALSE(surface.contains({3.5, 0.0, 1.5}));
    EXPECT_TRUE(surface.contains({1.5, 0.0, 2.5}));
    EXPECT_TRUE(surface.contains({4.5, 0.0, 2.4}));
    EXPECT_TRUE(surface.contains({3.5, 0.0, 0.5}));
  }
}

TEST(Field, InvalidFacesAreReportedWithTheReason) {
  EXPECT_EQ(refusal_of({{0, 0, 0}, {3, 0, 0}, {1, 2, 0}, {2, 2.5, 0}}),
            "its edges from corner 2 to 3 and from 4 to 1 cross each other; cut the face "
            "into triangles in the program that made it");
  // A bow tie of two equal halves has no side that is its front.
  EXPECT_NE(refusal_of({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).find("cross"),
            std::string::npos);
  // A hole that runs the same way as the outline.
  EXPECT_NE(refusal_of({{0, 0, 0},
                        {9, 0, 0},
                        {9, 9, 0},
                        {0, 9, 0},
                        {0, 0, 0},
                        {3, 3, 0},
                        {6, 3, 0},
                        {6, 6, 0},
                        {3, 6, 0},
                        {3, 3, 0}})
                .find("a hole must run the other way round"),
            std::string::npos);
  Ring round;
  for (int i = 0; i < 5000; ++i) {
    round.push_back({std::cos(i * 0.001), std::sin(i * 0.001), 0.0});
  }
  EXPECT_NE(refusal_of(round).find("it has 5000 corners"), std::string::npos);
}

std::string ply(const std::string& corners, const std::string& faces, int vertices, int count) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         corners + faces;
}

std::string scene_error(const std::string& file, const std::string& bytes) {
  const std::string xml =
      "<scene version='3.0.0'><bsdf type='diffuse' id='mat-itu_concrete'/>\n<shape type='" +
      file.substr(file.size() - 3) + "' id='mesh-floor'><string name='filename' value='" + file +
      "'/><ref id='mat-itu_concrete'/></shape></scene>";
  const auto scene =
      parse_scene(xml, "scene.xml", {5.18e9, {}}, [&](const std::string&) { return bytes; });
  return scene ? "no error" : scene.error().message;
}

TEST(Field, FaceThatCannotBeCutIsNamedByShapeAndNumber) {
  const std::string corners = "0 0 0\n3 0 0\n1 2 0\n2 2.5 0\n";
  EXPECT_EQ(scene_error("floor.ply", ply(corners, "3 0 1 2\n4 0 1 2 3\n", 4, 2)),
            "scene.xml:2:1: shape 'floor': floor.ply: face 2 of 2: its edges from corner 2 to 3 "
            "and from 4 to 1 cross each other; cut the face into triangles in the program "
            "that made it");
  EXPECT_EQ(scene_error("floor.obj",
                        "v 0 0 0\nv 3 0 0\nv 1 2 0\nv 2 2.5 0\nf 1 2 3\n\nf 1 2 3 4\nf 2 3 4\n"),
            "scene.xml:2:1: shape 'floor': floor.obj:7: face 2 of 3: its edges from corner 2 to 3 "
            "and from 4 to 1 cross each other; cut the face into triangles in the program "
            "that made it");
  EXPECT_EQ(scene_error("floor.ply", ply(corners, "3 0 1 2\n3 0 1 4\n", 4, 2)),
            "scene.xml:2:1: shape 'floor': floor.ply: face 2 of 2: it refers to vertex 4 of 4, "
            "counted from 0");
}

TEST(Field, FaceWithoutAreaIsLeftToTheScene) {
  const auto mesh =
      read_ply(ply("0 0 0\n1 0 0\n2 0 0\n0 1 0\n", "4 0 1 2 1\n2 0 1\n3 0 1 3\n", 4, 3), "a.ply");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 4U);
  EXPECT_NEAR(area(*mesh), 0.5, 1e-15);
}

TEST(Field, TriangleStripsOfAPlyFileAreRead) {
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n4 0 0\n0 3 0\n4 3 0\n0 6 0\n9 9 9\n"
      "9 0 1 2 3 4 -1 0 1 5\n";
  const auto mesh = read_mesh(bytes, "FLOOR.PLY");
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->triangles.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [a, b, c] = mesh->triangles[i];
    const auto& v = mesh->vertices;
    EXPECT_EQ(cross(v[b] - v[a], v[c] - v[a]), (Vec3d{0, 0, 12})) << i;
  }
  EXPECT_EQ(mesh->triangles[3], (std::array<std::uint32_t, 3>{0, 1, 5}));
}

TEST(Field, PlusSignsOfAPlyFileAreRead) {
  const auto mesh = read_ply(ply("+4.0 +0 -1\n0 +1e1 0\n0 0 +.5\n", "3 +0 1 2\n", 3, 1), "a.ply");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->vertices[0], (Vec3d{4.0, 0.0, -1.0}));
  EXPECT_EQ(mesh->vertices[1], (Vec3d{0.0, 10.0, 0.0}));
  EXPECT_FALSE(read_ply(ply("+-4.0 0 0\n0 1 0\n0 0 1\n", "3 0 1 2\n", 3, 1), "a.ply"));
}

TEST(Field, ObjFileOfEveryHabitIsRead) {
  const auto mesh = read_obj(
      "\xef\xbb\xbf# quads, negative indices, weights, colours, groups, a line, a point\r\n"
      "mtllib none.mtl\r\no box\r\n"
      "v 0 0 0 1.0\r\nv 2 0 0 2.0\r\nv 1 1 0 1.0\r\nv 0 1 0\r\n"
      "v 0 0 1 0.5 0.5 0.5\r\nv 1 0 1 0.5 0.5 0.5\r\nv 1 1 1\r\nv +0 1 1\r\n"
      "vn 0 0 -1\r\nvt 0 0\r\ng sides\r\nusemtl a\r\ns off\r\n"
      "f 4 3 2 1\r\nf -4 -3 -2 \\\r\n  -1\r\nusemtl b\r\n"
      "f 1//1 2//1 6//1 5//1\r\nf 2/1/1 3/1/1 7/1/1 6/1/1\r\nf 3/1 4/1 8/1 7/1\r\nf 4 1 5 8 # "
      "last\r\n"
      "l 1 7\r\np 3\r\n",
      "box.obj");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->vertices.size(), 8U);
  EXPECT_EQ(mesh->triangles.size(), 12U);
  EXPECT_NEAR(area(*mesh), 6.0, 1e-15);
  const auto surfaces = planar_surfaces(*mesh);
  EXPECT_EQ(surfaces.size(), 6U);
}

TEST(Field, ObjFileKeepsTheDigitsOfMapCoordinates) {
  const auto mesh = read_obj(
      "v 691001.4003 5334001.8001 520.7\nv 691002.4 5334001.8 520.7\nv 691001.4 5334002.8 520.7\n"
      "f 1 2 3\n",
      "a.obj");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->vertices[0], (Vec3d{691001.4003, 5334001.8001, 520.7}));
}

TEST(Field, ObjFileThatIsNotUnderstoodIsNamedWithItsLine) {
  const auto error_of = [](const std::string& bytes) {
    const auto mesh = read_obj(bytes, "a.obj");
    return mesh ? "no error" : mesh.error().message;
  };
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(error_of(square), "a.obj: the mesh has no face");
  EXPECT_EQ(error_of("v 0 0\n"), "a.obj:1: vertex 1 must have three coordinates");
  EXPECT_EQ(error_of("v 0 0 0\nv 0,5 0 0\n"),
            "a.obj:2: a coordinate of vertex 2 is not a finite number");
  EXPECT_EQ(error_of(square + "f 1 2 x\n"),
            "a.obj:5: 'x' is no corner of a face; corners are numbers of vertices, from 1 on or "
            "backwards from -1, as in 'f 1 2 3'");
  EXPECT_NE(error_of(square + "f 1 2 0\n").find("a.obj:5: '0' is no corner"), std::string::npos);
  EXPECT_NE(error_of(square + "f 1 2 -5\n").find("a.obj:5: '-5' is no corner"), std::string::npos);
  EXPECT_EQ(error_of(square + "\nf 1 2\n"),
            "a.obj:6: a face has 2 corners, three or more are needed");
  EXPECT_EQ(error_of(square + "f 1 2 3\nfaces 1 2 3\n"),
            "a.obj:6: 'faces' is no statement of an OBJ file");
  EXPECT_EQ(error_of(square + "cstype bezier\n"),
            "a.obj:5: 'cstype' begins a curved surface; export the mesh as polygons");
  EXPECT_EQ(error_of(square + "f 1 2 3\nf 1 2 5\n"),
            "a.obj:6: face 2 of 2: it refers to vertex 4 of 4, counted from 0");
}

}  // namespace
}  // namespace rayloc::field_faces_test
