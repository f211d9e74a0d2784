// Tests the geometry of a site that the map receives, for the bundled site.
#include "daemon/live/live_map/map_geometry.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/live/live_map/map_solid.h"
#include "daemon/site/model/room_model.h"
#include "tests/support/test_paths.h"

namespace rayloc::map_geometry_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class MapGeometryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto site = load_site(test::data_path("/sites/meeting_room"));
    ASSERT_TRUE(site) << site.error().message;
    site_ = std::move(*site);
    auto room = load_room_model(site_);
    ASSERT_TRUE(room) << room.error().message;
    room_ = std::move(*room);
  }

  Site site_;
  RoomModel room_;
};

// Twice the area, by the shoelace formula.
double doubled_area(const json& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const json& a = corners[i];
    const json& b = corners[(i + 1) % corners.size()];
    sum += a[0].get<double>() * b[1].get<double>() - b[0].get<double>() * a[1].get<double>();
  }
  return std::abs(sum);
}

TEST_F(MapGeometryTest, ContainsTheRoomAndItsFurniture) {
  const json map = json::parse(map_geometry_json(site_, room_, {"rayloc", "spotfi"}));
  EXPECT_EQ(map.at("site"), "meeting_room");
  EXPECT_EQ(map.at("bounds").at("min"), json({-1.765, -1.425, 0.0}));
  EXPECT_EQ(map.at("bounds").at("max"), json({1.765, 1.425, 2.7}));
  EXPECT_EQ(map.at("methods"), json({"rayloc", "spotfi"}));
  EXPECT_FALSE(map.contains("georeference"));
  std::map<std::string, int> kinds;
  double floor = 0.0;
  for (const json& shape : map.at("plan")) {
    ++kinds[shape.at("kind")];
    const json& points = shape.contains("area") ? shape.at("area") : shape.at("line");
    for (const json& point : points) {
      EXPECT_LT(std::abs(point.at(0).get<double>()), 2.5);
      EXPECT_LT(std::abs(point.at(1).get<double>()), 2.0);
    }
    if (shape.at("kind") == "floor") {
      floor += 0.5 * doubled_area(points);
    }
  }
  EXPECT_GT(floor, 3.53 * 2.85 * 0.99);
  EXPECT_GT(kinds["furniture"], 2);
  EXPECT_GE(kinds["cut"], 4) << "walls";
}

// Corner by corner, from the hinge along the side of the room.
TEST_F(MapGeometryTest, DrawsDoorsAndWindowsAsGapsInTheirWalls) {
  const json plan = json::parse(map_geometry_json(site_, room_, {"rayloc", "spotfi"})).at("plan");
  const auto corners = [&](const std::string& name, const std::string& kind) {
    std::vector<std::vector<double>> found;
    for (const json& shape : plan) {
      if (shape.at("name") == name) {
        EXPECT_EQ(shape.at("kind"), kind) << name << " is drawn once";
        found = shape.at("area");
      }
    }
    return found;
  };
  using Corners = std::vector<std::vector<double>>;
  EXPECT_EQ(corners("door", "door"),
            (Corners{{1.725, -1.25}, {1.725, -0.35}, {1.885, -0.35}, {1.885, -1.25}}))
      << "through the wall behind it, and hinged at the nearer corner of the room";
  EXPECT_EQ(corners("window", "window"),
            (Corners{{1.1, 1.405}, {-0.7, 1.405}, {-0.7, 1.545}, {1.1, 1.545}}));
  EXPECT_FALSE(corners("whiteboard", "cut furniture").empty()) << "no opening, and no wall";
}

TEST_F(MapGeometryTest, HoldsTheRoomAsASolid) {
  const json solid = json::parse(map_solid_json(*room_.scene));
  const auto reach = [](const json& faces, std::size_t axis) {
    double most = -10.0;
    for (const json& face : faces) {
      for (const json& corner : face.at("corners")) {
        most = std::max(most, corner.at(axis).get<double>());
      }
    }
    return most;
  };
  EXPECT_GT(solid.at("faces").size(), 30U);
  EXPECT_NEAR(reach(solid.at("faces"), 2), 2.7, 1e-3) << "walls";
  EXPECT_GT(reach(solid.at("open"), 2), 2.7) << "edges alone of the ceiling";
  EXPECT_NEAR(reach(solid.at("open"), 0), 1.885, 1e-3) << "edges alone of the south wall";
  EXPECT_THAT(solid.at("faces").at(0).at("colour").get<std::string>(), HasSubstr("#"));
  std::vector<std::string> names;
  for (const json& one : solid.at("names")) {
    names.push_back(one.at("name"));
  }
  EXPECT_THAT(names, ::testing::Contains("table"));
}

TEST_F(MapGeometryTest, ContainsAccessPointsAndFixedTransmitters) {
  const json map = json::parse(map_geometry_json(site_, room_, {"rayloc", "spotfi"}));
  ASSERT_EQ(map.at("access_points").size(), 3U);
  const json& ap2 = map.at("access_points").at(1);
  EXPECT_EQ(ap2.at("id"), "ap2");
  EXPECT_EQ(ap2.at("position"), json({1.45, 1.0, 1.2}));
  EXPECT_NEAR(ap2.at("facing").at(0).get<double>(), std::cos(-145.0 * M_PI / 180.0), 1e-9);
  EXPECT_NEAR(ap2.at("facing").at(1).get<double>(), std::sin(-145.0 * M_PI / 180.0), 1e-9);
  EXPECT_EQ(ap2.at("antennas").size(), 3U);
  ASSERT_EQ(map.at("fixed_transmitters").size(), 1U);
  EXPECT_EQ(map.at("fixed_transmitters").at(0).at("mac"), "02:52:4c:00:00:02");
}

TEST_F(MapGeometryTest, HoldsZonesAndWhereTheSiteIsOnEarth) {
  SiteZone& zone = site_.zones.emplace_back();
  zone.name = "desk \xff";
  zone.polygon = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}};
  site_.georeference = {52.5, 13.25, 34.0, M_PI / 2.0};
  const json map = json::parse(map_geometry_json(site_, room_, {"rayloc", "spotfi"}));
  EXPECT_EQ(map.at("zones").at(0).at("polygon"), json({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}));
  EXPECT_EQ(map.at("zones").at(0).at("name"), "desk \xef\xbf\xbd") << "bytes that are no text";
  EXPECT_EQ(map.at("georeference").at("latitude"), 52.5);
  EXPECT_NEAR(map.at("georeference").at("rotation_deg").get<double>(), 90.0, 1e-9);
}

TEST_F(MapGeometryTest, GivesTheReasonForAMissingMap) {
  EXPECT_EQ(json::parse(map_without_room_json(site_, "so \xff")),
            json({{"site", "meeting_room"}, {"available", false}, {"reason", "so \xef\xbf\xbd"}}));
  EXPECT_EQ(json::parse(map_without_calibration_json("so")),
            json({{"available", false}, {"reason", "so"}}));
}

TEST_F(MapGeometryTest, ShowsOnlyTheReportOfTheCalibrationInUse) {
  EXPECT_THAT(map_calibration_json(site_, room_), HasSubstr("not calibrated"));
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "map_geometry_test";
  std::filesystem::create_directories(folder);
  const auto parsed = [&](const std::string& report) {
    std::ofstream(folder / "report.json") << report;
    return json::parse(map_calibration_json(site_, room_));
  };
  site_.calibration_file = folder / "calibration.toml";
  room_.calibration_id = "abc";
  EXPECT_THAT(parsed("no json").at("reason").get<std::string>(), HasSubstr("no report"));
  EXPECT_THAT(parsed(R"({"calibration_id": "abd"})").at("reason").get<std::string>(),
              HasSubstr("of another one"));
  const json report =
      parsed(R"({"calibration_id": "abc", "method": "joint", "moved": [1], "history": [2]})");
  EXPECT_TRUE(report.at("available"));
  EXPECT_EQ(report.at("moved"), json({1}));
  EXPECT_FALSE(report.contains("history")) << "not for the map";
  EXPECT_FALSE(report.contains("expectation"));
  EXPECT_EQ(
      parsed(R"({"calibration_id": "abc", "verdict": {"expectation": "Good"}})").at("expectation"),
      "Good");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rayloc::map_geometry_test
