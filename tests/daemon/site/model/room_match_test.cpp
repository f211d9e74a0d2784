#include "daemon/site/model/room_match.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/model/room_model.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::room_match_test {
namespace {

using test::box_mesh;
using test::NamedMesh;
using test::rectangle_mesh;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Change = std::function<Vec3d(const Vec3d&)>;

// A room from the origin, of sheets as an architect's program writes them.
std::vector<NamedMesh> room_of(const Vec3d& size) {
  const auto& [x, y, z] = size;
  return {{"floor", rectangle_mesh({0, 0, 0}, {x, 0, 0}, {0, y, 0})},
          {"ceiling", rectangle_mesh({0, 0, z}, {x, 0, 0}, {0, y, 0})},
          {"wall_s", rectangle_mesh({0, 0, 0}, {x, 0, 0}, {0, 0, z})},
          {"wall_n", rectangle_mesh({0, y, 0}, {x, 0, 0}, {0, 0, z})},
          {"wall_w", rectangle_mesh({0, 0, 0}, {0, y, 0}, {0, 0, z})},
          {"wall_e", rectangle_mesh({x, 0, 0}, {0, y, 0}, {0, 0, z})},
          {"table", box_mesh({1, 1, 0.7}, {2.4, 1.8, 0.74})}};
}

const Vec3d kOffice{4, 3, 2.5};
const Vec3d kCorridor{31, 2.7, 2.8};

std::shared_ptr<const Scene> scene_of(std::vector<NamedMesh> meshes, const Change& change) {
  for (NamedMesh& each : meshes) {
    for (Vec3d& vertex : each.mesh.vertices) {
      vertex = change(vertex);
    }
  }
  return test::make_scene(meshes, test::kConcrete);
}

Change scaled(double factor) {
  return [factor](const Vec3d& p) { return factor * p; };
}
Vec3d as_it_is(const Vec3d& p) { return p; }
Vec3d y_up(const Vec3d& p) { return {p.x, p.z, -p.y}; }

// Without [bounds] where `size` is nothing.
Site site_with(const Vec3d& size, std::vector<Vec3d> access_points) {
  Site site;
  site.scene_file = "scene.xml";
  site.has_bounds = size.x > 0.0;
  site.bounds_max = size;
  for (const Vec3d& place : access_points) {
    SiteAccessPoint ap;
    ap.id = "ap" + std::to_string(site.access_points.size() + 1);
    ap.rx_chains = {0};
    ap.array.element_offset = {{0, 0, 0}};
    ap.array.pose.position = place;
    site.access_points.push_back(std::move(ap));
  }
  return site;
}
Site office_site() { return site_with(kOffice, {{0.4, 0.4, 1.2}}); }
Site site_without_bounds() { return site_with({}, {{0.4, 0.4, 1.2}}); }

// "error unit: message", one a line.
std::string found(const Scene& scene, const Site* site) {
  std::string text;
  for (const RoomFinding& finding : room_findings(scene, site)) {
    text += (finding.is_error ? "error " : "warning ") + finding.kind + ": " + finding.message;
    text += "\n";
  }
  return text;
}

TEST(Field, RoomThatIsAsStatedIsSilent) {
  const Site office = office_site();
  const Site without = site_without_bounds();
  const Site corridor = site_with(kCorridor, {{0.4, 0.4, 2.2}, {30, 2, 2.2}});
  EXPECT_EQ(found(*scene_of(room_of(kOffice), as_it_is), &office), "");
  EXPECT_EQ(found(*scene_of(room_of(kOffice), as_it_is), &without), "");
  EXPECT_EQ(found(*scene_of(room_of(kOffice), as_it_is), nullptr), "");
  EXPECT_EQ(found(*scene_of(room_of(kCorridor), as_it_is), &corridor), "");
  const auto askew = scene_of(room_of(kCorridor), [](const Vec3d& p) {
    return Vec3d{0.6 * p.x - 0.8 * p.y, 0.8 * p.x + 0.6 * p.y, p.z};
  });
  EXPECT_EQ(found(*askew, nullptr), "");
  const auto site = load_site(test::data_path("/sites/meeting_room"));
  ASSERT_TRUE(site);
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_EQ(found(*room->scene, &*site), "");
}

struct UnitCase {
  const char* name;
  double metres;
};

TEST(Field, RoomInAnotherUnitIsNamed) {
  const Site office = office_site();
  for (const auto& [name, metres] : {UnitCase{"centimetres", 0.01},
                                     UnitCase{"millimetres", 0.001},
                                     UnitCase{"inches", 0.0254},
                                     UnitCase{"feet", 0.3048}}) {
    EXPECT_THAT(found(*scene_of(room_of(kOffice), scaled(1.0 / metres)), &office),
                AllOf(HasSubstr("error unit: the scene is not the room that [bounds] states"),
                      HasSubstr(std::string("its vertices are in ") + name)));
    // The other way round it is the site that is not in metres.
    Site site = office;
    site.bounds_max = (1.0 / metres) * site.bounds_max;
    site.access_points[0].array.pose.position =
        (1.0 / metres) * site.access_points[0].array.pose.position;
    EXPECT_THAT(found(*scene_of(room_of(kOffice), as_it_is), &site),
                AllOf(HasSubstr("error unit: "),
                      HasSubstr(std::string("the lengths of the site are in ") + name)));
  }
  EXPECT_THAT(found(*scene_of(room_of(kOffice), scaled(0.01)), &office),
              AllOf(HasSubstr("error unit: "), HasSubstr("100 times too small")));
}

TEST(Field, RoomOfABuildingInAnotherUnitIsNamed) {
  std::vector<NamedMesh> building = room_of({30, 20, 2.5});
  for (NamedMesh& mesh : room_of(kOffice)) {
    mesh.name += "_of_the_office";
    building.push_back(std::move(mesh));
  }
  const Site office = office_site();
  EXPECT_EQ(found(*scene_of(building, as_it_is), &office), "");
  EXPECT_THAT(found(*scene_of(building, scaled(1000.0)), &office),
              HasSubstr("its vertices are in millimetres"));
}

TEST(Field, RoomWithAnotherAxisUpNamesTheAxesToExchange) {
  const Site office = office_site();
  EXPECT_THAT(found(*scene_of(room_of(kOffice), y_up), &office),
              AllOf(HasSubstr("error axes: "),
                    HasSubstr("y of the room is -z of the scene, z of the room is y of the scene"),
                    HasSubstr("its floor and ceiling lie along y: exchange y and z"),
                    HasSubstr("<rotate x=\"1\" angle=\"90\"/>")));
  const auto x_up = [](const Vec3d& p) { return Vec3d{p.z, p.y, -p.x}; };
  EXPECT_THAT(found(*scene_of(room_of(kOffice), x_up), &office),
              AllOf(HasSubstr("error axes: "), HasSubstr("lie along x: exchange x and z")));
  const auto centimetres_y_up = [](const Vec3d& p) { return 100.0 * y_up(p); };
  EXPECT_THAT(found(*scene_of(room_of(kOffice), centimetres_y_up), &office),
              AllOf(HasSubstr("its vertices are in centimetres"), HasSubstr("lie along y")));
  const auto plan_rotated = [](const Vec3d& p) { return Vec3d{p.y, p.x, p.z}; };
  EXPECT_THAT(found(*scene_of(room_of(kOffice), plan_rotated), &office),
              HasSubstr("x of the room is y of the scene, y of the room is x of the scene"));
}

TEST(Field, RoomWithAnotherOriginSuggestsATranslation) {
  const Site office = office_site();
  const auto centred = [](const Vec3d& p) { return p - Vec3d{2, 1.5, 0}; };
  EXPECT_THAT(found(*scene_of(room_of(kOffice), centred), &office),
              AllOf(HasSubstr("error origin: "), HasSubstr("move it by 2.000, 1.500, 0.000 m")));
  const auto mirrored = [](const Vec3d& p) { return Vec3d{-p.x, p.y, p.z}; };
  EXPECT_THAT(found(*scene_of(room_of(kOffice), mirrored), &office),
              AllOf(HasSubstr("error origin: "),
                    HasSubstr("move it by 4.000, 0.000, 0.000 m"),
                    HasSubstr("; or is the sign of x wrong?")));
  const auto upstairs = [](const Vec3d& p) { return p + Vec3d{500, 700, 520}; };
  EXPECT_THAT(found(*scene_of(room_of(kOffice), upstairs), &office),
              HasSubstr("move it by -500.000, -700.000, -520.000 m"));
}

// Without a wall at the sides of [bounds], they give no evidence on unit or axes.
TEST(Field, RoomInAHallIsSilent) {
  const auto hall = scene_of(room_of({20, 15, 6}), as_it_is);
  Site corner = office_site();
  EXPECT_EQ(found(*hall, &corner), "");
  corner.bounds_min = {5, 5, 0};
  corner.bounds_max = {11, 9, 2.5};
  corner.access_points[0].array.pose.position = {6, 6, 2};
  EXPECT_EQ(found(*hall, &corner), "");
}

// [bounds] may be any part of the room: bounds inside of it give no evidence on its unit.
TEST(Field, RoomThatHoldsTheBoundsIsNeverRefused) {
  const auto scene = scene_of(room_of(kOffice), as_it_is);
  std::mt19937_64 random(25);
  const auto within = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  for (int i = 0; i < 500; ++i) {
    Site site = office_site();
    site.bounds_min = {within(0, 3.5), within(0, 2.5), within(-0.1, 0.3)};
    site.bounds_max = {
        within(site.bounds_min.x + 0.5, 4), within(site.bounds_min.y + 0.5, 3), within(1.5, 2.6)};
    EXPECT_EQ(found(*scene, &site), "") << i;
  }
}

// Rooms of many sizes, written in all ways that are known, are all found out.
TEST(Field, RoomOfAnySizeInAnotherFrameIsRefused) {
  std::mt19937_64 random(25);
  const auto within = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  for (int i = 0; i < 100; ++i) {
    const Vec3d size{within(3.5, 30), within(2, 12), within(2.3, 4)};
    const Site site = site_with(size, {{0.4, 0.4, 1.2}});
    const double metres =
        std::array{1.0, 0.01, 0.001, 0.0254, 0.3048}.at(static_cast<std::size_t>(i) % 5);
    const bool rotated = i % 2 == 0 || metres == 1.0;
    const auto scene = scene_of(
        room_of(size), [&](const Vec3d& p) { return (1.0 / metres) * (rotated ? y_up(p) : p); });
    EXPECT_THAT(found(*scene, &site), HasSubstr(metres < 1.0 ? "error unit: " : "error axes: "))
        << i << " " << size.x << " " << size.y << " " << size.z;
    const auto right = scene_of(room_of(size), as_it_is);
    EXPECT_EQ(found(*right, &site), "");
  }
}

TEST(Field, OpenAirIsSilentWhereASiteStatesIt) {
  const auto yard = scene_of({{"ground", rectangle_mesh({-20, -20, 0}, {40, 0, 0}, {0, 40, 0})},
                              {"shed", box_mesh({5, 5, 0}, {8, 8, 3})}},
                             as_it_is);
  const Site office = office_site();
  EXPECT_EQ(found(*yard, &office), "");
  EXPECT_THAT(found(*yard, nullptr),
              HasSubstr("warning no_ceiling: no pair of large horizontal faces"));
}

TEST(Field, BoundsBeyondTheSceneAreReported) {
  Site site = office_site();
  site.bounds_max.x = 9;
  EXPECT_THAT(
      found(*scene_of(room_of(kOffice), as_it_is), &site),
      HasSubstr("warning bounds: [bounds] states x from 0 to 9 m, and the scene is smaller, "
                "from 0 to 4 m"));
  site.bounds_min.x = 6;
  site.access_points[0].array.pose.position.x = 6;
  EXPECT_THAT(found(*scene_of(room_of(kOffice), as_it_is), &site),
              HasSubstr("error bounds: [bounds] states x from 6 to 9 m, and the scene lies apart "
                        "from it, from 0 to 4 m: both need one origin"));
}

TEST(Field, AntennasOutsideTheSceneAreReported) {
  const auto scene = scene_of(room_of(kOffice), as_it_is);
  const auto at = [&](const Vec3d& place) {
    const Site site = site_with({}, {{0.4, 0.4, 1.2}, place});
    return found(*scene, &site);
  };
  EXPECT_EQ(at({4.3, 1, 3.2}), "");  // behind the wall, above the ceiling
  EXPECT_THAT(at({7, 1, 1.2}),
              HasSubstr("warning antenna_outside: the antenna of core 0 of access point 'ap2' is "
                        "3.0 m outside of the scene, at 7, 1, 1.2"));
  EXPECT_THAT(at({40, 1, 1.2}), HasSubstr("error antenna_outside: "));
  Site fixed = site_without_bounds();
  fixed.transmitters.emplace_back().position = Vec3d{1, -40, 1.2};
  EXPECT_THAT(found(*scene, &fixed), HasSubstr("error antenna_outside: the fixed transmitter "));
  const Site centimetres = site_with({}, {{40, 40, 120}});
  EXPECT_THAT(found(*scene, &centimetres),
              HasSubstr("error unit: all antennas of the site are above the scene (4 x 3 x 2.5 m): "
                        "the lengths of the site are in centimetres"));
}

TEST(Field, RoomWithoutBoundsIsJudgedByItsSize) {
  const Site site = site_without_bounds();
  const auto centimetres = scene_of(room_of(kOffice), scaled(100.0));
  EXPECT_THAT(found(*centimetres, &site),
              AllOf(HasSubstr("error unit: the scene is 400 x 300 x 250 m large; in centimetres it "
                              "would be 4 x 3 x 2.5 m"),
                    HasSubstr("state [bounds] of the room")));
  EXPECT_THAT(found(*centimetres, nullptr),
              HasSubstr("warning scale: the scene is 400 x 300 x 250 m large; in centimetres"));
  EXPECT_THAT(found(*scene_of(room_of(kOffice), scaled(1.0 / 0.0254)), nullptr),
              HasSubstr("large; in inches it would be 4 x 3 x 2.5 m"));
  EXPECT_THAT(found(*scene_of(room_of({900, 800, 40}), as_it_is), nullptr),
              HasSubstr("warning scale: "));
}

TEST(Field, NamesOfFloorAndCeilingIndicateTheUpAxis) {
  const Site site = site_without_bounds();
  const auto scene = scene_of(room_of(kOffice), y_up);
  EXPECT_THAT(found(*scene, &site),
              HasSubstr("error axes: an object that is named a floor or a ceiling is upright, "
                        "across y: exchange y and z"));
  EXPECT_THAT(found(*scene, nullptr), HasSubstr("warning axes: "));
  // Without names, from what is missing.
  const auto part = scene_of({{"a", rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 3, 0})},
                              {"b", rectangle_mesh({0, 0, 2.5}, {4, 0, 0}, {0, 3, 0})}},
                             y_up);
  EXPECT_THAT(found(*part, nullptr),
              HasSubstr("warning axes: no large horizontal face, but a pair across y: if they are "
                        "floor and ceiling, exchange y and z"));
  EXPECT_EQ(found(*scene_of(room_of(kOffice), as_it_is), &site), "");
}

TEST(Field, RoomThatIsNotTheStatedOneIsNotLoaded) {
  auto site = load_site(test::data_path("/sites/meeting_room"));
  ASSERT_TRUE(site);
  site->bounds_min = 100.0 * site->bounds_min;
  site->bounds_max = 100.0 * site->bounds_max;
  const auto room = load_room_model(*site);
  ASSERT_FALSE(room);
  EXPECT_EQ(room.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(room.error().message,
              AllOf(HasSubstr("meeting_room/scene.xml: the scene is not the room"),
                    HasSubstr("the lengths of the site are in centimetres; write metres")));
}

}  // namespace
}  // namespace rayloc::room_match_test
