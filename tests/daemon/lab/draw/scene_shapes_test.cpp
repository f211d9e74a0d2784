// Tests the elements of a picture: faces, sections, parts.
#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "daemon/lab/draw/labels.h"
#include "daemon/site/plan/face.h"
#include "daemon/site/plan/mesh_section.h"
#include "daemon/site/plan/scene_parts.h"
#include "daemon/site/scene/build_room.h"
#include "engine/scene/read/load_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::draw::scene_shapes_test {
namespace {

double area_of(const std::vector<Vec3d>& corners) {
  Vec3d twice;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    twice = twice + cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  }
  return 0.5 * norm(twice);
}

// A room of 5 x 4 x 3 m with a hole of 1 x 2 m in its western wall.
std::shared_ptr<const Scene> room_with_a_hole() {
  const auto plan = parse_room_plan(
      "name = \"x\"\nsize = [5, 4, 3]\nfloor = \"concrete\"\nceiling = \"concrete\"\nwalls = "
      "\"brick\"\n[[opening]]\nname = \"gap\"\nwall = \"west\"\ncentre = [2, 1.5]\nsize = [1, 2]\n",
      "room.toml");
  const auto files = scene_files(build_room(*plan));
  auto scene =
      parse_scene(files.at("scene.xml"),
                  "scene.xml",
                  {test::kCarrier, {}},
                  [&](const std::string& name) -> Expected<std::string> { return files.at(name); });
  return std::make_shared<const Scene>(*std::move(scene));
}

TEST(SceneFaces, CoverEverySurfaceOnce) {
  const auto scene = room_with_a_hole();
  std::map<std::uint32_t, double> areas;
  for (const Face& face : scene_faces(*scene)) {
    areas[face.object] += area_of(face.corners);
    EXPECT_EQ(face.corners.size(), face.outlined.size());
  }
  EXPECT_NEAR(areas[0], 5.0 * 4.0, 1e-12);
  EXPECT_NEAR(areas[2], 4.0 * 3.0 - 2.0, 1e-12);
  EXPECT_NEAR(areas[3], 4.0 * 3.0, 1e-12);
}

TEST(SceneFaces, OutlineIsThatOfTheSurfaceAndItsHoles) {
  double outline = 0.0;
  for (const Face& face : scene_faces(*room_with_a_hole())) {
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Vec3d& next = face.corners[(i + 1) % face.corners.size()];
      outline += face.object == 2 && face.outlined[i] ? norm(next - face.corners[i]) : 0.0;
    }
  }
  EXPECT_NEAR(outline, 2.0 * (4.0 + 3.0) + 2.0 * (1.0 + 2.0), 1e-12);
}

TEST(SceneFaces, NormalsOfBodiesPointOutwardsForAnyMeshOrientation) {
  Mesh inside_out = test::box_mesh({1, 1, 1}, {2, 2, 2});
  for (auto& triangle : inside_out.triangles) {
    std::swap(triangle[1], triangle[2]);
  }
  const auto scene = test::make_scene(
      {{"a", test::box_mesh({1, 1, 1}, {2, 2, 2})}, {"b", inside_out}}, test::kConcrete);
  for (const Face& face : scene_faces(*scene)) {
    EXPECT_TRUE(face.solid);
    EXPECT_GT(dot(face.normal, face.corners[0] - Vec3d{1.5, 1.5, 1.5}), 0.0);
  }
}

TEST(MeshSection, BoxGivesItsOutline) {
  const MeshSection section = cut_mesh(test::box_mesh({1, 2, 0}, {3, 5, 2}), 1.3);
  EXPECT_TRUE(section.lines.empty());
  ASSERT_EQ(section.loops.size(), 1U);
  EXPECT_NEAR(area_of(section.loops[0]), 6.0, 1e-12);
  for (const Vec3d& corner : section.loops[0]) {
    EXPECT_EQ(corner.z, 1.3);
  }
}

TEST(MeshSection, SheetGivesALineAndAHoleDividesIt) {
  const auto scene = room_with_a_hole();
  const MeshSection whole = cut_mesh(scene->objects()[3].mesh, 1.3);
  EXPECT_TRUE(whole.loops.empty());
  ASSERT_EQ(whole.lines.size(), 1U);
  EXPECT_NEAR(norm(whole.lines[0].front() - whole.lines[0].back()), 4.0, 1e-12);
  const MeshSection divided = cut_mesh(scene->objects()[2].mesh, 1.3);
  ASSERT_EQ(divided.lines.size(), 2U);
  for (const auto& line : divided.lines) {
    EXPECT_NEAR(norm(line.front() - line.back()), 1.5, 1e-12);
  }
}

TEST(MeshSection, IsEmptyAboveAndBelow) {
  for (const double z : {-0.1, 2.1}) {
    const MeshSection section = cut_mesh(test::box_mesh({1, 2, 0}, {3, 5, 2}), z);
    EXPECT_TRUE(section.loops.empty());
    EXPECT_TRUE(section.lines.empty());
  }
}

TEST(MeshSection, CutThroughCornersIsStillClosed) {
  const MeshSection section = cut_mesh(test::box_mesh({1, 2, 0}, {3, 5, 2}), 2.0);
  ASSERT_EQ(section.loops.size(), 1U);
  EXPECT_NEAR(area_of(section.loops[0]), 6.0, 1e-12);
}

TEST(SceneParts, DistinguishFloorsWallsAndFurniture) {
  const auto scene =
      load_scene(test::data_path("/sites/meeting_room/scene.xml"), {test::kCarrier, {}});
  ASSERT_TRUE(scene) << scene.error().message;
  std::map<std::string, PartKind> kinds;
  for (const ScenePart& part : scene_parts(*scene)) {
    kinds[part.name] = part.kind;
  }
  EXPECT_EQ(kinds.at("floor"), PartKind::kFloor);
  EXPECT_EQ(kinds.at("ceiling"), PartKind::kCeiling);
  for (const char* name : {"wall_west", "wall_east", "wall_south", "wall_north"}) {
    EXPECT_EQ(kinds.at(name), PartKind::kWall) << name;
  }
  for (const char* name : {"table", "cabinet", "window", "chair0_back"}) {
    EXPECT_EQ(kinds.at(name), PartKind::kFurniture) << name;
  }
}

Text label(double x, double y) { return {{x, y}, "name", 10.0, {}}; }

TEST(Labels, TakeTheFirstPlaceThatIsClear) {
  Labels labels;
  labels.place({label(0, 0)});
  labels.place({label(5, 2), label(100, 2), label(200, 2)});
  ASSERT_EQ(labels.texts().size(), 2U);
  EXPECT_EQ(labels.texts()[1].at.x, 100.0);
}

TEST(Labels, OmitTextsWithoutAFreePlace) {
  Labels labels;
  labels.reserve(label(0, 0));
  labels.place({label(5, 2)});
  EXPECT_TRUE(labels.texts().empty());
}

TEST(Labels, ReserveTheHeightOfUprightTexts) {
  Labels labels;
  Text upright = label(0, 0);
  upright.degrees = 90.0;
  labels.place({upright});
  labels.place({label(3, -15)});   // crosses it
  labels.place({label(20, -15)});  // beside it
  EXPECT_EQ(labels.texts().size(), 2U);
}

}  // namespace
}  // namespace rayloc::draw::scene_shapes_test
