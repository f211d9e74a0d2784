#include "daemon/site/scene/scene_report.h"

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/site/scene/solid_around.h"
#include "daemon/site/scene/surface_overlap.h"
#include "tests/support/scenes.h"

namespace rayloc::scene_report_test {
namespace {

using test::box_mesh;
using test::rectangle_mesh;

// A room of 4 x 3 x 2.5 m: a shell around everything, and a box in the middle of it.
std::vector<test::NamedMesh> room_with(const std::string& name, Mesh mesh) {
  return {{"shell", box_mesh({0, 0, 0}, {4, 3, 2.5})}, {name, std::move(mesh)}};
}

SceneReport report_of(const std::vector<test::NamedMesh>& meshes,
                      std::optional<Site> site = std::nullopt) {
  return inspect_scene({"test", "", test::make_scene(meshes, test::kConcrete), std::move(site)});
}

std::vector<std::string> kinds_of(const SceneReport& report) {
  std::vector<std::string> kinds;
  for (const SceneWarning& warning : report.warnings) {
    kinds.push_back(warning.kind);
  }
  return kinds;
}

using Kinds = std::vector<std::string>;

TEST(SceneReport, CountsObjectsAndMaterials) {
  const SceneReport report =
      report_of({{"box", box_mesh({1, 1, 0}, {2, 2, 1})},
                 {"sheet", rectangle_mesh({0, 0, 2}, {4, 0, 0}, {0, 3, 0})}});
  EXPECT_EQ(kinds_of(report), Kinds{"no_ceiling"});
  ASSERT_EQ(report.objects.size(), 2U);
  EXPECT_EQ(report.objects[0].name, "box");
  EXPECT_EQ(report.objects[0].material, "concrete");
  EXPECT_EQ(report.objects[0].form, ObjectForm::kClosed);
  EXPECT_EQ(report.objects[0].surfaces, 6U);
  EXPECT_EQ(report.objects[0].triangles, 12U);
  EXPECT_EQ(report.objects[0].bounds.lower, (Vec3d{1, 1, 0}));
  EXPECT_EQ(report.objects[0].bounds.upper, (Vec3d{2, 2, 1}));
  EXPECT_EQ(report.objects[1].form, ObjectForm::kSheet);
  EXPECT_EQ(report.objects[1].surfaces, 1U);
  ASSERT_EQ(report.materials.size(), 1U);
  EXPECT_EQ(report.materials[0].objects, 2U);
}

TEST(Field, FacesDrawnFromBothSidesNeedNoWarning) {
  Mesh box = box_mesh({0, 0, 0}, {4, 3, 2.5});
  const auto outer = box.triangles;
  for (const auto& [a, b, c] : outer) {
    box.triangles.push_back({a, c, b});
  }
  EXPECT_EQ(kinds_of(report_of({{"shell", box}})), Kinds{});
}

TEST(Field, FaceDrawnFromBothSidesIsSharedOnce) {
  // Cut along either diagonal, so that no triangle is there twice.
  Mesh table = rectangle_mesh({1, 1, 0}, {1, 0, 0}, {0, 1, 0});
  table.triangles.push_back({0, 1, 3});
  table.triangles.push_back({1, 2, 3});
  const auto scene = test::make_scene(
      {{"floor", rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 3, 0})}, {"table", table}},
      test::kConcrete);
  const auto overlaps = find_overlaps(*scene);
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_NEAR(overlaps[0].area, 1.0, 1e-9);
}

TEST(SceneReport, WarnsOfDroppedTriangles) {
  Mesh mesh = box_mesh({1, 1, 0}, {2, 2, 1});
  mesh.triangles.push_back({0, 0, 1});
  const SceneReport report = report_of({{"box", mesh}});
  EXPECT_EQ(report.dropped_triangles, 1U);
  EXPECT_EQ(kinds_of(report), Kinds{"degenerate_triangle"});
}

TEST(SceneReport, WarnsOfMillimetres) {
  EXPECT_EQ(kinds_of(report_of({{"box", box_mesh({0, 0, 0}, {4000, 3000, 2500})}})),
            Kinds{"scale"});
}

TEST(SceneReport, WarnsOfAnInsideOutMesh) {
  Mesh mesh = box_mesh({1, 1, 1}, {2, 2, 2});
  for (auto& triangle : mesh.triangles) {
    std::swap(triangle[1], triangle[2]);
  }
  EXPECT_EQ(kinds_of(report_of(room_with("chest", mesh))), Kinds{"inside_out"});
  // As the shell of the whole room it is right that it faces inwards.
  EXPECT_EQ(kinds_of(report_of({{"shell", mesh}})), Kinds{});
}

TEST(SceneReport, WarnsOfABodyWithoutAnInside) {
  Mesh mesh = box_mesh({1, 1, 1}, {2, 2, 2});
  mesh.triangles.pop_back();
  const SceneReport report = report_of(room_with("chest", mesh));
  EXPECT_EQ(kinds_of(report), Kinds{"open_body"});
  EXPECT_NE(report.warnings[0].message.find("object 'chest' has 6 surfaces and no inside"),
            std::string::npos)
      << report.warnings[0].message;
}

TEST(SceneReport, WarnsOfAntennasInsideAndOutside) {
  Site site;
  SiteAccessPoint ap;
  ap.id = "ap1";
  ap.rx_chains = {0, 2, 3};
  ap.array.pose.position = {1.5, 1.5, 1.5};
  ap.array.element_offset = {{0, 0, 0}, {0, 1, 0}, {0, 5, 0}};
  site.access_points = {ap};
  const SceneReport report = report_of(room_with("block", box_mesh({1, 1, 1}, {2, 2, 2})), site);
  EXPECT_EQ(kinds_of(report), (Kinds{"antenna_inside", "antenna_outside"}));
  EXPECT_EQ(report.warnings[0].message,
            "the antenna of core 0 of access point 'ap1' is inside of object 'block', where it "
            "receives nothing");
  EXPECT_EQ(
      report.warnings[1].message,
      "the antenna of core 3 of access point 'ap1' is 3.5 m outside of the scene, at 1.5, 6.5, "
      "1.5");
}

TEST(SolidAround, DistinguishesInteriorsFromFacesAndTheRoom) {
  const auto scene =
      test::make_scene(room_with("block", box_mesh({1, 1, 1}, {2, 2, 2})), test::kConcrete);
  EXPECT_EQ(solid_around(*scene, {1.5, 1.5, 1.5}), 1U);
  EXPECT_EQ(solid_around(*scene, {1.0 + 1e-6, 1.5, 1.5}), 1U);
  EXPECT_EQ(solid_around(*scene, {1.0, 1.5, 1.5}), std::nullopt);
  EXPECT_EQ(solid_around(*scene, {0.5, 1.5, 1.5}), std::nullopt);  // in the shell of the room only
}

TEST(SurfaceOverlap, CabinetOnTheFloorIsAContact) {
  const auto scene = test::make_scene({{"floor", box_mesh({0, 0, -0.1}, {4, 3, 0})},
                                       {"cabinet", box_mesh({1, 1, 0}, {1.5, 1.4, 1})}},
                                      test::kConcrete);
  const auto overlaps = find_overlaps(*scene);
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_FALSE(overlaps[0].doubled);
  EXPECT_NEAR(overlaps[0].area, 0.2, 1e-12);
}

TEST(SurfaceOverlap, CabinetOnAFloorSheetIsAContact) {
  const auto scene = test::make_scene({{"floor", rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 3, 0})},
                                       {"cabinet", box_mesh({1, 1, 0}, {1.5, 1.4, 1})}},
                                      test::kConcrete);
  const auto overlaps = find_overlaps(*scene);
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_FALSE(overlaps[0].doubled);
}

TEST(SurfaceOverlap, PictureSunkIntoTheWallIsDoubled) {
  const auto scene = test::make_scene({{"wall", box_mesh({0, 0, 0}, {4, 0.2, 2.5})},
                                       {"picture", box_mesh({1, 0.15, 1}, {2, 0.2, 1.5})},
                                       {"floor", box_mesh({0, 0.2, -0.1}, {4, 3, 0})}},
                                      test::kConcrete);
  const auto overlaps = find_overlaps(*scene);
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_TRUE(overlaps[0].doubled);
  EXPECT_NEAR(overlaps[0].area, 0.5, 1e-12);
}

TEST(SurfaceOverlap, SheetWithinAWallIsDoubled) {
  const auto scene = test::make_scene({{"wall", rectangle_mesh({0, 1, 0}, {4, 0, 0}, {0, 0, 2.5})},
                                       {"poster", rectangle_mesh({3, 1, 1}, {2, 0, 0}, {0, 0, 1})},
                                       {"floor", rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 3, 0})}},
                                      test::kConcrete);
  const auto overlaps = find_overlaps(*scene);
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_TRUE(overlaps[0].doubled);
  EXPECT_NEAR(overlaps[0].area, 1.0, 1e-12);
}

TEST(SurfaceOverlap, NeighboursThatShareAnEdgeDoNotOverlap) {
  const auto scene =
      test::make_scene({{"left", rectangle_mesh({0, 0, 0}, {2, 0, 0}, {0, 3, 0})},
                        {"right", rectangle_mesh({2, 0, 0}, {2, 0, 0}, {0, 3, 0})},
                        {"above", rectangle_mesh({0, 0, 0.001}, {4, 0, 0}, {0, 3, 0})}},
                       test::kConcrete);
  EXPECT_TRUE(find_overlaps(*scene).empty());
}

TEST(SurfaceOverlap, IsFoundInATiltedPlaneAsWell) {
  const Vec3d u{1, 0, 0.2};
  const Vec3d v{0.1, 1, 0.3};
  const auto scene = test::make_scene({{"a", rectangle_mesh({5, 5, 1}, u, v)},
                                       {"b", rectangle_mesh(Vec3d{5, 5, 1} + 0.5 * u, v, u)}},
                                      test::kConcrete);
  const auto overlaps = find_overlaps(*scene);
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_NEAR(overlaps[0].area, 0.5 * norm(cross(u, v)), 1e-9);
}

}  // namespace
}  // namespace rayloc::scene_report_test
