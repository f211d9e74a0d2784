// A plan becomes files, the files a scene, the scene paths.
#include "daemon/site/scene/build_room.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/site/scene/access_point_presets.h"
#include "daemon/site/scene/room_site.h"
#include "engine/base/constants.h"
#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"
#include "tests/daemon/site/scene/room_text.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::build_room_test {
namespace {

using testing::kRoomFile;
using testing::plan_scene;
using testing::room_text;

TEST(Field, SceneFilesOfAnyNameAreRead) {
  const Mesh wall = test::rectangle_mesh({0, 0, 0}, {1, 0, 0}, {0, 0, 2});
  StatedScene stated;
  stated.materials.push_back({"a \"b\" & <c>", "", 3.0, 0.1, 0.2});
  for (const char* name : {"a/b", "a\\b", "../../etc", "wall <1> & \"2\"", "$x", "plain"}) {
    stated.objects.push_back({name, stated.materials[0].name, wall});
  }
  const auto files = scene_files(stated);
  EXPECT_EQ(files.size(), stated.objects.size() + 1);
  const auto scene =
      parse_scene(files.at("scene.xml"),
                  "scene.xml",
                  {test::kCarrier, {}},
                  [&](const std::string& name) -> Expected<std::string> { return files.at(name); });
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects().size(), stated.objects.size());
  for (std::size_t i = 0; i < stated.objects.size(); ++i) {
    EXPECT_EQ(scene->objects()[i].name, stated.objects[i].name);
  }
  EXPECT_EQ(scene->materials()[0].name, stated.materials[0].name);
  EXPECT_TRUE(files.contains("meshes/plain.ply"));
}

std::optional<std::uint32_t> object_named(const Scene& scene, const std::string& name) {
  for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
    if (scene.objects()[i].name == name) {
      return i;
    }
  }
  return std::nullopt;
}

// The area of all surfaces of the object [m^2].
double area_of(const Scene& scene, const std::string& name) {
  double area = 0.0;
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    area += scene.owner(i).object == object_named(scene, name) ? scene.surfaces()[i].area() : 0.0;
  }
  return area;
}

TEST(BuildRoom, HasTheObjectsOfThePlan) {
  const auto scene = plan_scene(room_text());
  ASSERT_NE(scene, nullptr);
  std::vector<std::string> names;
  for (const SceneObject& object : scene->objects()) {
    names.push_back(object.name + "/" + scene->materials()[object.material].name);
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"floor/concrete",
                                      "ceiling/ceiling_board",
                                      "wall_west/plasterboard",
                                      "wall_east/plasterboard",
                                      "wall_south/plasterboard",
                                      "wall_north/outer",
                                      "door/wood",
                                      "table/wood",
                                      "screen/cork"}));
  EXPECT_EQ(scene->bounds_min(), (Vec3d{-1, 0, 0}));
  EXPECT_EQ(scene->bounds_max(), (Vec3d{4.2, 3.4, 2.7}));
  EXPECT_EQ(scene->dropped_triangles(), 0U);
}

TEST(BuildRoom, SurfacesHaveTheAreaOfThePlan) {
  const auto scene = plan_scene(room_text());
  ASSERT_NE(scene, nullptr);
  EXPECT_NEAR(area_of(*scene, "floor"), 5.2 * 3.4, 1e-12);
  EXPECT_NEAR(area_of(*scene, "wall_west"), 3.4 * 2.7, 1e-12);
  EXPECT_NEAR(area_of(*scene, "wall_east"), 3.4 * 2.7 - 0.9 * 2.0, 1e-12);
  EXPECT_NEAR(area_of(*scene, "door"), 0.9 * 2.0, 1e-12);
  EXPECT_NEAR(area_of(*scene, "wall_south"), 5.2 * 2.7 - 0.9 * 2.1, 1e-12);
  EXPECT_NEAR(area_of(*scene, "table"), 2.0 * (1.8 * 0.9 + 1.8 * 0.05 + 0.9 * 0.05), 1e-12);
  EXPECT_NEAR(area_of(*scene, "screen"), 1.2 * 1.6, 1e-12);
  // Each side is one mirror whatever is cut out of it; a box has six.
  EXPECT_EQ(scene->surfaces().size(), 6U + 1U + 6U + 1U);
}

TEST(BuildRoom, MaterialsAreThoseOfThePlan) {
  const auto scene = plan_scene(room_text());
  ASSERT_NE(scene, nullptr);
  std::map<std::string, RadioMaterial> materials;
  for (const RadioMaterial& material : scene->materials()) {
    materials[material.name] = material;
  }
  EXPECT_EQ(materials.at("outer").relative_permittivity, 3.91);
  EXPECT_EQ(materials.at("outer").thickness, 0.24);
  EXPECT_EQ(materials.at("plasterboard").thickness, 0.0125);
  EXPECT_EQ(materials.at("cork"), (RadioMaterial{"cork", 1.8, 0.01, kDefaultThickness}));
}

TEST(BuildRoom, SidesFaceInwardsAndBoxesOutwards) {
  const auto scene = plan_scene(room_text());
  ASSERT_NE(scene, nullptr);
  const Vec3d middle{1.6, 1.7, 1.35};
  for (std::uint32_t i = 0; i < scene->surfaces().size(); ++i) {
    const std::uint32_t object = scene->owner(i).object;
    EXPECT_TRUE(scene->owner(i).one_facing) << scene->objects()[object].name;
    if (object < kRoomSides.size()) {
      EXPECT_GT(distance(scene->surfaces()[i].plane(), middle), 0.0) << kRoomSides.at(object);
    }
  }
  const Solid table = scene->solid(*object_named(*scene, "table"));
  EXPECT_EQ(table.shells, 1);
  EXPECT_EQ(table.orientation, 1);
}

TEST(BuildRoom, BoxIsRotatedAnticlockwise) {
  const auto scene = plan_scene(room_text());
  ASSERT_NE(scene, nullptr);
  const Mesh& table = scene->objects()[*object_named(*scene, "table")].mesh;
  const Vec3d along{std::cos(30.0 * std::acos(-1.0) / 180.0), 0.5, 0.0};
  double furthest = 0.0;
  for (const Vec3d& v : table.vertices) {
    furthest = std::max(furthest, dot(along, v - Vec3d{1.0, 1.5, 0.73}));
  }
  EXPECT_NEAR(furthest, 0.9, 1e-12);
}

// Lengths of all paths up to two reflections in an empty room, by its images: along each axis the
// image of order n is at 2 n L +- x.
std::vector<double> image_lengths(const Vec3d& size, const Vec3d& from, const Vec3d& to) {
  const auto images = [](double length, double x) {
    std::vector<std::pair<int, double>> found;  // number of reflections, coordinate
    for (int n = -2; n <= 2; ++n) {
      found.emplace_back(std::abs(2 * n), 2.0 * n * length + x);
      found.emplace_back(std::abs(2 * n - 1), 2.0 * n * length - x);
    }
    return found;
  };
  std::vector<double> lengths;
  for (const auto& [i, x] : images(size.x, from.x)) {
    for (const auto& [j, y] : images(size.y, from.y)) {
      for (const auto& [k, z] : images(size.z, from.z)) {
        if (i + j + k <= 2) {
          lengths.push_back(norm(Vec3d{x, y, z} - to));
        }
      }
    }
  }
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

TEST(BuildRoom, EmptyRoomHasThePathsOfItsImages) {
  const auto scene = plan_scene(
      "name = \"x\"\nsize = [5.2, 3.4, 2.7]\nfloor = \"concrete\"\nceiling = \"concrete\"\nwalls = "
      "\"brick\"\n");
  ASSERT_NE(scene, nullptr);
  const Vec3d tx{1.1, 0.7, 1.2};
  const Vec3d rx{4.0, 2.9, 1.9};
  std::vector<double> lengths;
  for (const Path& path :
       PathTracer(scene, {.max_depth = 2}).trace(Transmitter{{tx, {}}}, Receiver{{rx, {}}})) {
    lengths.push_back(path.tau * kSpeedOfLight);
  }
  std::sort(lengths.begin(), lengths.end());
  const std::vector<double> expected = image_lengths({5.2, 3.4, 2.7}, tx, rx);
  ASSERT_EQ(expected.size(), 25U);
  ASSERT_EQ(lengths.size(), expected.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_NEAR(lengths[i], expected[i], 1e-12);
  }
}

// Objects that single reflections touch.
std::vector<std::string> single_bounces(const std::shared_ptr<const Scene>& scene,
                                        const Vec3d& tx,
                                        const Vec3d& rx) {
  std::vector<std::string> names;
  for (const Path& path :
       PathTracer(scene, {.max_depth = 1}).trace(Transmitter{{tx, {}}}, Receiver{{rx, {}}})) {
    if (path.interactions.size() == 1) {
      names.push_back(scene->objects()[path.interactions[0].object].name);
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST(BuildRoom, HoleReflectsNothingAndAPaneAsItself) {
  const std::string room =
      "name = \"x\"\nsize = [5, 4, 3]\nfloor = \"concrete\"\nceiling = \"concrete\"\nwalls = "
      "\"brick\"\n[[opening]]\nname = \"gap\"\nwall = \"west\"\ncentre = [2, 1.5]\nsize = [1, 1]\n";
  const Vec3d tx{1, 1.9, 1.5};
  const Vec3d rx{2, 2.1, 1.5};
  const std::vector<std::string> others{
      "ceiling", "floor", "wall_east", "wall_north", "wall_south"};
  EXPECT_EQ(single_bounces(plan_scene(room), tx, rx), others);
  std::vector<std::string> with_pane = others;
  with_pane.insert(with_pane.begin() + 2, "gap");
  EXPECT_EQ(single_bounces(plan_scene(room + "material = \"glass\"\n"), tx, rx), with_pane);
}

TEST(RoomSite, IsASiteOnceAnAccessPointIsNamed) {
  const auto plan = parse_room_plan(room_text(), kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  const std::string text = room_site(*plan);
  const auto lacking = parse_site(text, "site.toml");
  ASSERT_FALSE(lacking);
  EXPECT_NE(lacking.error().message.find("the file lacks 'access_point'"), std::string::npos);
  // The instructions of the comment are right: without its '#' only the scene file is missing here.
  std::string uncommented = text;
  for (std::size_t at = 0; (at = uncommented.find("\n# [", at)) != std::string::npos;) {
    uncommented.erase(at + 1, 2);
  }
  for (const char* key : {"id =", "position =", "yaw_deg =", "core =", "offset ="}) {
    const std::string line = std::string("\n# ") + key;
    for (std::size_t at = 0; (at = uncommented.find(line)) != std::string::npos;) {
      uncommented.erase(at + 1, 2);
    }
  }
  const auto complete = parse_site(uncommented, "/nowhere/site.toml");
  ASSERT_FALSE(complete);
  EXPECT_EQ(complete.error().message.find("/nowhere/site.toml:2:9: 'scene': no file"), 0U)
      << complete.error().message;
  EXPECT_EQ(complete.error().message.find('\n'), std::string::npos) << complete.error().message;
}

TEST(RoomSite, AKnownModelIsWrittenReady) {
  const auto plan = parse_room_plan(room_text(), kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  // Each with the order of its cores.
  const std::map<std::string, std::vector<std::uint8_t>> rx_chains = {{"RT-AX86U", {2, 0, 3}},
                                                                      {"RT-AC86U", {0, 1, 2}}};
  for (const std::string& model : preset_models()) {
    const std::string text = room_site(*plan, model);
    EXPECT_NE(text.find("[[access_point]]  # " + model + ", three antennas"), std::string::npos);
    const auto site = parse_site(text, test::data_path("/sites/meeting_room/site.toml"));
    ASSERT_TRUE(site) << site.error().message;
    ASSERT_EQ(site->access_points.size(), 1U);
    const SiteAccessPoint& ap = site->access_points[0];
    EXPECT_EQ(ap.rx_chains, rx_chains.at(model));
    EXPECT_EQ(ap.array.element_offset[0], (Vec3d{0, -0.089, 0}));
    EXPECT_EQ(ap.array.element_offset[2], (Vec3d{0, 0.089, 0}));
    // In the room, below its ceiling, and looking at its middle.
    EXPECT_GT(ap.array.pose.position.z, 1.5);
    EXPECT_LT(ap.array.pose.position.z, plan->upper.z);
    const Vec3d middle = 0.5 * (plan->lower + plan->upper) - ap.array.pose.position;
    EXPECT_NEAR(ap.array.pose.orientation.yaw, std::atan2(middle.y, middle.x), 0.01);
  }
}

TEST(RoomSite, AccessPointsAndCarrierComeBackAsStated) {
  const std::string stated =
      "[carrier]\nchannel = 42\nbandwidth_mhz = 80\ncentre_hz = 5210000000\ntones = 256\nactive = "
      "[[-122, -2], [2, 122]]\n"
      "[[access_point]]\nid = \"ap-1\"\nformat = \"axcsi-v4\"\nposition = [0.3, 0.1, 2.2]\n"
      "yaw_deg = 33.3\npitch_deg = -7.1\npolarization = \"H\"\npattern = \"dipole\"\n"
      "[[access_point.antenna]]\ncore = 2\noffset = [0, -0.089, 0]\n"
      "[[access_point.antenna]]\ncore = 0\noffset = [0, 0.1, 0]\n";
  const auto plan = parse_room_plan(room_text() + stated, kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  // scene.xml of the meeting room replaces the one that would be beside it.
  const auto site = parse_site(room_site(*plan), test::data_path("/sites/meeting_room/site.toml"));
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_EQ(site->name, "office");
  EXPECT_EQ(site->bounds_min, plan->lower);
  EXPECT_EQ(site->bounds_max, plan->upper);
  EXPECT_EQ(site->carrier.channel, 42);
  EXPECT_EQ(site->carrier.grid, plan->carrier.grid);
  ASSERT_EQ(site->access_points.size(), 1U);
  const SiteAccessPoint& ap = site->access_points[0];
  EXPECT_EQ(ap.id, "ap-1");
  EXPECT_EQ(ap.format, "axcsi-v4");
  EXPECT_EQ(ap.rx_chains, (std::vector<std::uint8_t>{2, 0}));
  EXPECT_EQ(ap.array.pose.position, (Vec3d{0.3, 0.1, 2.2}));
  EXPECT_EQ(ap.array.element_offset, plan->access_points[0].array.element_offset);
  EXPECT_NEAR(ap.array.pose.orientation.yaw, 33.3 * std::acos(-1.0) / 180.0, 1e-12);
  EXPECT_EQ(ap.array.pattern, AntennaPattern::kDipole);
  EXPECT_EQ(ap.array.polarization, Polarization::kHorizontal);
}

}  // namespace
}  // namespace rayloc::build_room_test
