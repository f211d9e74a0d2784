// The JSON of phone room scanners. No phone is here: these are written from the published layout of
// RoomPlan's CapturedRoom (16 numbers column by column, y up, metres), not by a phone.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/base/constants.h"
#include "tests/daemon/site/import/import_files.h"

namespace rayloc::room_scan_test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr double kRotated = 30.0 * kDegree;  // the phone began the scan anyhow
constexpr double kHeight = 2.5;              // [m]

// A box with its centre at x, y, z of the room (z up), rotated by `yaw`, in a phone's format.
Json box(const std::string& list,
         const Json& category,
         const Vec3d& at,
         double yaw,
         const std::vector<double>& size,
         const std::string& parent = "") {
  static int number = 0;
  const double x = std::cos(kRotated) * at.x - std::sin(kRotated) * at.y + 3.0;
  const double y = std::sin(kRotated) * at.x + std::cos(kRotated) * at.y - 1.0;
  const double c = std::cos(yaw + kRotated);
  const double s = std::sin(yaw + kRotated);
  Json one = {{"identifier", list + std::to_string(++number)},
              {"category", category},
              {"confidence", {{"high", Json::object()}}},
              {"dimensions", size},
              {"transform", {c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, x, at.z - 1.4, -y, 1}},
              {"curve", nullptr},
              {"story", 0}};
  one["parentIdentifier"] = parent.empty() ? Json() : Json(parent);
  return one;
}

// 5 x 3.6 m: a door that is closed and one that is open, a window, a passage, a table, a washer.
Json office() {
  const Json wall = {{"wall", Json::object()}};
  Json room = {{"version", 2}, {"identifier", "A"}, {"story", 0}, {"sections", Json::array()}};
  room["walls"] = {box("wall", wall, {2.5, 0, 1.25}, 0, {5, kHeight, 0}),
                   box("wall", wall, {5, 1.8, 1.25}, 90 * kDegree, {3.6, kHeight, 0.14}),
                   box("wall", wall, {2.5, 3.6, 1.25}, 180 * kDegree, {5, kHeight, 0}),
                   box("wall", wall, {0, 1.8, 1.25}, 270 * kDegree, {3.6, kHeight, 0})};
  const auto id = [&](std::size_t i) { return room["walls"][i]["identifier"].get<std::string>(); };
  const Json closed = {{"door", {{"isOpen", false}}}};
  const Json open = {{"door", {{"isOpen", true}}}};
  // The second names no wall; it is in that which it is nearest to.
  room["doors"] = {box("door", closed, {1, 0.02, 1}, 0, {0.9, 2, 0.04}, id(0)),
                   box("door", open, {4.9, 1, 1}, 90 * kDegree, {0.8, 2, 0}, "no such wall")};
  // A list of one in braces is a list to one compiler, and a copy to another.
  room["windows"] = Json::array(
      {box("window", {{"window", Json::object()}}, {3, 3.6, 1.5}, 0, {1.6, 1.2, 0}, id(2))});
  room["openings"] = Json::array(
      {box("opening", {{"opening", Json::object()}}, {0, 1, 1}, 90 * kDegree, {1, 2, 0}, id(3))});
  room["objects"] = {
      box("object", {{"table", Json::object()}}, {2, 2, 0.37}, 20 * kDegree, {1.6, 0.74, 0.8}),
      box("object", {{"washerDryer", Json::object()}}, {4.6, 3.2, 0.45}, 0, {0.6, 0.9, 0.6})};
  room["floors"] = Json::array();
  return room;
}

class RoomScan : public test::ImportFiles {
 protected:
  Expected<ImportedScene> imported(const Json& json) const {
    return import(file("room.json", json.dump()));
  }
  std::string refusal(const Json& json) const {
    return ImportFiles::refusal("room.json", json.dump());
  }
};

// [m^2]
double area_of(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    area +=
        0.5 * norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
  }
  return area;
}

const StatedObject& object_of(const ImportedScene& scene, const std::string& name) {
  static const StatedObject kNone;
  const auto found = std::find_if(scene.scene.objects.begin(),
                                  scene.scene.objects.end(),
                                  [&](const StatedObject& one) { return one.name == name; });
  EXPECT_NE(found, scene.scene.objects.end()) << name;
  return found == scene.scene.objects.end() ? kNone : *found;
}

TEST_F(RoomScan, WallsOpeningsAndFurnitureBecomeARoom) {
  const auto room = imported(office());
  ASSERT_TRUE(room) << room.error().message;
  // For any orientation of the scan, the room is parallel to the axes at the origin.
  EXPECT_NEAR(room->bounds.lower.x, 0.0, 1e-9);
  EXPECT_NEAR(room->bounds.lower.y, 0.0, 1e-9);
  EXPECT_NEAR(room->bounds.lower.z, 0.0, 1e-9);
  EXPECT_NEAR(room->bounds.upper.x, 5.0, 1e-9);
  EXPECT_NEAR(room->bounds.upper.y, 3.6, 1e-9);
  EXPECT_NEAR(room->bounds.upper.z, kHeight, 1e-9);
  EXPECT_NEAR(area_of(object_of(*room, "wall").mesh), 5 * kHeight - 0.9 * 2, 1e-9);
  EXPECT_NEAR(area_of(object_of(*room, "wall_2").mesh), 3.6 * kHeight - 0.8 * 2, 1e-9);
  EXPECT_NEAR(area_of(object_of(*room, "wall_3").mesh), 5 * kHeight - 1.6 * 1.2, 1e-9);
  EXPECT_NEAR(area_of(object_of(*room, "wall_4").mesh), 3.6 * kHeight - 2, 1e-9);
  EXPECT_NEAR(area_of(object_of(*room, "door").mesh), 0.9 * 2, 1e-9);
  EXPECT_EQ(object_of(*room, "door").material, "wood");
  const StatedObject& window = object_of(*room, "window");
  EXPECT_EQ(window.material, "glass");
  Bounds pane;
  for (const Vec3d& v : window.mesh.vertices) {
    pane.include(v);
  }
  EXPECT_NEAR(pane.lower.x, 2.2, 1e-9);
  EXPECT_NEAR(pane.upper.x, 3.8, 1e-9);
  EXPECT_NEAR(pane.lower.y, 3.6, 1e-9);
  EXPECT_NEAR(pane.lower.z, 0.9, 1e-9);
  const StatedObject& table = object_of(*room, "table");
  EXPECT_EQ(table.material, "wood_2") << "thinner than the door";
  EXPECT_NEAR(area_of(table.mesh), 2 * (1.6 * 0.74 + 1.6 * 0.8 + 0.74 * 0.8), 1e-9);
  Vec3d middle{};
  for (const Vec3d& v : table.mesh.vertices) {
    middle = middle + (1.0 / 8.0) * v;
  }
  EXPECT_NEAR(norm(middle - Vec3d{2, 2, 0.37}), 0.0, 1e-9);
  const Vec3d along = table.mesh.vertices.at(1) - table.mesh.vertices.at(0);
  EXPECT_NEAR(std::atan2(along.y, along.x), 20 * kDegree, 1e-9);
  EXPECT_EQ(object_of(*room, "washerDryer").material, "metal");
  EXPECT_NEAR(area_of(object_of(*room, "floor").mesh), 5 * 3.6, 1e-9);
  const std::string text = remarks(*room);
  EXPECT_THAT(text, HasSubstr("rotated by -30.0 degrees"));
  EXPECT_THAT(text,
              HasSubstr("4 walls, 2 doors and windows that are closed, 2 openings and open "
                        "doors, 2 pieces of furniture"));
  EXPECT_THAT(text, HasSubstr("the rectangle around the walls, 2.50 m apart"));
  EXPECT_THAT(text, Not(HasSubstr("left out")));
}

TEST_F(RoomScan, UsesThicknessesOfTheScanIfPresent) {
  const auto room = imported(office());
  ASSERT_TRUE(room) << room.error().message;
  const auto thickness = [&](const std::string& object) {
    const std::string& name = object_of(*room, object).material;
    const auto& all = room->scene.materials;
    return std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; })
        ->thickness;
  };
  EXPECT_NEAR(thickness("wall_2"), 0.14, 1e-12);
  EXPECT_NEAR(thickness("door"), 0.04, 1e-12);
  EXPECT_NEAR(thickness("wall"), 0.0125, 1e-12) << "of plasterboard";
}

TEST_F(RoomScan, TheFloorHasTheOutlineOfTheScan) {
  Json room = office();
  // Flat, its own x along the room's, its y to the room's -y; an L.
  Json floor = box("floor", {{"floor", Json::object()}}, {2.5, 1.8, 0}, 0, {5, 3.6, 0});
  const double c = std::cos(kRotated);
  const double s = std::sin(kRotated);
  Json& m = floor["transform"];
  const Json rotated = {c, 0, -s, 0, s, 0, c, 0, 0, -1, 0, 0};
  std::copy(rotated.begin(), rotated.end(), m.begin());
  floor["polygonCorners"] = {
      {-2.5, -1.8, 0}, {2.5, -1.8, 0}, {2.5, 0.8, 0}, {0.5, 0.8, 0}, {0.5, 1.8, 0}, {-2.5, 1.8, 0}};
  room["floors"] = Json::array({floor});
  const auto made = imported(room);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NEAR(area_of(object_of(*made, "floor").mesh), 5 * 3.6 - 2 * 1, 1e-9);
  EXPECT_NEAR(area_of(object_of(*made, "ceiling").mesh), 5 * 3.6 - 2 * 1, 1e-9);
}

TEST_F(RoomScan, ReportsEveryIgnoredElement) {
  Json room = office();
  room["version"] = 7;
  room["roofs"] = Json::array();
  room["walls"][0]["curve"] = {{"radius", 3}};
  room["windows"][0]["confidence"] = {{"low", Json::object()}};
  room["objects"].push_back(box("object", {{"hammock", Json::object()}}, {1, 1, 1}, 0, {2, 1, 1}));
  room["objects"][0]["transform"] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  room["doors"].push_back(
      box("door", {{"door", {{"isOpen", false}}}}, {2, 2, 1}, 0, {0.9, 2, 0}, "gone"));
  const auto made = imported(room);
  ASSERT_TRUE(made) << made.error().message;
  const std::string text = remarks(*made);
  EXPECT_THAT(text, HasSubstr("warning: it is of version 7, which is not known"));
  EXPECT_THAT(text, HasSubstr("left out, as it is not known here: roofs"));
  EXPECT_THAT(text, HasSubstr("bent, of which the chord was taken: walls[0]"));
  EXPECT_THAT(text, HasSubstr("low confidence, check them: windows[0]"));
  EXPECT_THAT(text, HasSubstr("no row of the table of materials is of hammock"));
  EXPECT_THAT(text, HasSubstr("left out: 1 doors, windows or openings that are in no wall"));
  EXPECT_THAT(text, HasSubstr("left out: 1 pieces of furniture that lean"));
}

TEST_F(RoomScan, RefusesInvalidScansWithTheirPosition) {
  EXPECT_THAT(ImportFiles::refusal("room.json", "{\"walls\": ["),
              HasSubstr("is cut off, or no JSON"));
  EXPECT_THAT(refusal({{"rooms", 3}}), HasSubstr("is JSON, but neither glTF"));
  EXPECT_THAT(refusal({{"walls", 3}}), HasSubstr("its 'walls' is no list"));
  EXPECT_THAT(refusal({{"walls", Json::array()}}), HasSubstr("has no wall; scan the room again"));
  EXPECT_THAT(refusal({{"walls", {3}}}), HasSubstr("walls[0]: its 'dimensions' are no three"));
  Json room = office();
  room["walls"][1]["transform"].push_back(0);
  EXPECT_THAT(refusal(room), HasSubstr("walls[1]: its 'transform' is no list of 16 numbers"));
  room = office();
  room["objects"][0]["dimensions"][1] = -1;
  EXPECT_THAT(refusal(room), HasSubstr("objects[0]: its 'dimensions'"));
  // Row by row, or larger than life.
  room = office();
  Json& m = room["doors"][0]["transform"];
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      std::swap(m[4 * i + k], m[4 * k + i]);
    }
  }
  EXPECT_THAT(refusal(room), HasSubstr("doors[0]: its 'transform' does more than turn and move"));
  room = office();
  room["walls"][0]["transform"][0] = 2;
  EXPECT_THAT(refusal(room), HasSubstr("walls[0]: its 'transform' does more than turn and move"));
}

}  // namespace
}  // namespace rayloc::room_scan_test
