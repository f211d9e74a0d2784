// A scan of a furnished room, made of the room's own scene: finely cut, and disturbed by a
// centimetre.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/import_scene.h"
#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/test_paths.h"

namespace rayloc::scan_test {
namespace {

namespace fs = std::filesystem;

constexpr double kCarrier = 5.19e9;

// Four of each until no side is longer.
void cut(const std::array<Vec3d, 3>& t, double longest, std::vector<std::array<Vec3d, 3>>& out) {
  const double side = std::max({norm(t[0] - t[1]), norm(t[1] - t[2]), norm(t[2] - t[0])});
  if (side <= longest) {
    out.push_back(t);
    return;
  }
  const Vec3d a = 0.5 * (t[0] + t[1]);
  const Vec3d b = 0.5 * (t[1] + t[2]);
  const Vec3d c = 0.5 * (t[2] + t[0]);
  for (const std::array<Vec3d, 3>& part : {std::array{t[0], a, c},
                                           std::array{a, t[1], b},
                                           std::array{c, b, t[2]},
                                           std::array{a, b, c}}) {
    cut(part, longest, out);
  }
}

struct Scan {
  std::size_t triangles = 0;
  std::string obj;
};

// y up, as phones and Blender write OBJ. `named`: with the objects' names and materials.
Scan scan_of(const Scene& scene, double longest, double noise, bool named) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, noise);
  Scan scan;
  std::size_t index = 0;
  for (const SceneObject& object : scene.objects()) {
    if (named) {
      scan.obj += "o " + object.name + "\nusemtl " + scene.materials()[object.material].name + "\n";
    }
    std::vector<std::array<Vec3d, 3>> parts;
    for (const auto& t : object.mesh.triangles) {
      cut({object.mesh.vertices[t[0]], object.mesh.vertices[t[1]], object.mesh.vertices[t[2]]},
          longest,
          parts);
    }
    std::map<std::tuple<long, long, long>, std::size_t> known;
    std::string faces;
    for (const auto& part : parts) {
      faces += "f";
      for (const Vec3d& p : part) {
        const auto key = [](double x) { return std::lround(x * 1e6); };
        const auto [found, added] = known.try_emplace({key(p.x), key(p.y), key(p.z)}, index + 1);
        if (added) {
          ++index;
          scan.obj += fmt::format("v {:.5f} {:.5f} {:.5f}\n",
                                  p.x + normal(random),
                                  p.z + normal(random),
                                  -(p.y + normal(random)));
        }
        faces += " " + std::to_string(found->second);
      }
      faces += "\n";
    }
    scan.obj += faces;
    scan.triangles += parts.size();
  }
  return scan;
}

std::shared_ptr<const Scene> scene_from(const StatedScene& stated) {
  const auto files = scene_files(stated);
  auto scene =
      parse_scene(files.at("scene.xml"),
                  "scene.xml",
                  {kCarrier, {}},
                  [&](const std::string& name) -> Expected<std::string> { return files.at(name); });
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return nullptr;
  }
  return std::make_shared<const Scene>(*std::move(scene));
}

std::shared_ptr<const Scene> meeting_room() {
  SceneOptions options{kCarrier, {}};
  for (const auto& [name, thickness] :
       std::vector<std::pair<std::string, double>>{{"ceiling_board", 0.015},
                                                   {"concrete", 0.1},
                                                   {"glass", 0.004},
                                                   {"metal", 0.01},
                                                   {"plasterboard", 0.0125},
                                                   {"wood", 0.02}}) {
    options.materials[name].thickness = thickness;
  }
  auto scene = load_scene(test::data_path("/sites/meeting_room/scene.xml"), options);
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return nullptr;
  }
  return std::make_shared<const Scene>(*std::move(scene));
}

// The share of the true paths' power that paths of the other scene carry, which have as many
// reflections, all within 15 cm of the true ones, and half to twice the power.
double matched_power(const std::shared_ptr<const Scene>& truth,
                     const std::shared_ptr<const Scene>& other) {
  constexpr double kNear = 0.15;  // [m]
  double power = 0.0;
  double matched = 0.0;
  const std::vector<Vec3d> points{
      {0.9, -0.8, 1.2}, {-0.4, 0.6, 1.0}, {1.2, 0.4, 1.2}, {-0.9, -0.3, 1.3}};
  const std::vector<Vec3d> access_points{{-1.4, 1.05, 2.2}, {1.4, -1.1, 2.2}};
  for (const Vec3d& tx : points) {
    for (const Vec3d& rx : access_points) {
      const auto paths = [&](const std::shared_ptr<const Scene>& scene) {
        return PathTracer(scene, {.max_depth = 2}).trace(Transmitter{{tx, {}}}, Receiver{{rx, {}}});
      };
      const Paths found = paths(other);
      std::vector<Path> candidates(found.begin(), found.end());
      for (const Path& path : paths(truth)) {
        const double of_path = abs2(path.a);
        power += of_path;
        for (auto it = candidates.begin(); it != candidates.end(); ++it) {
          bool same = it->interactions.size() == path.interactions.size();
          for (std::size_t i = 0; same && i < path.interactions.size(); ++i) {
            same = norm(it->interactions[i].position - path.interactions[i].position) < kNear;
          }
          const double its = abs2(it->a);
          if (same && its > 0.5 * of_path && its < 2.0 * of_path) {
            matched += of_path;
            candidates.erase(it);
            break;
          }
        }
      }
    }
  }
  return matched / power;
}

class Scanned : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = fs::temp_directory_path() / ("rayloc-scan-test." + std::to_string(::getpid()) + ".obj");
  }
  void TearDown() override { fs::remove(file_); }

  Expected<ImportedScene> import(const Scan& scan) const {
    std::ofstream(file_) << scan.obj;
    return import_scene(file_, *MaterialTable::parse(kDefaultMaterialTable, "materials"), {});
  }
  static std::string remarks(const ImportedScene& imported) {
    return fmt::format("{}", fmt::join(imported.remarks, "\n"));
  }

  fs::path file_;
};

TEST_F(Scanned, MeetingRoomHasThePathsOfTheTrueOne) {
  const auto room = meeting_room();
  ASSERT_NE(room, nullptr);
  const Scan scan = scan_of(*room, 0.08, 0.01, true);
  EXPECT_GE(scan.triangles, 100'000U);
  const auto imported = import(scan);
  ASSERT_TRUE(imported) << imported.error().message;
  const auto scene = scene_from(imported->scene);
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->objects().size(), room->objects().size());
  // Six of each box, and pieces along its edges that noise has parted.
  EXPECT_LE(scene->surfaces().size(), 12 * room->objects().size());
  const double share = matched_power(room, scene);
  RecordProperty("matched", fmt::format("{:.4f} of {} triangles", share, scan.triangles));
  RecordProperty("said", remarks(*imported));
  EXPECT_GE(share, 0.9) << remarks(*imported);
}

TEST_F(Scanned, WithoutNamesFloorWallsAndCeilingAreFound) {
  const auto room = meeting_room();
  ASSERT_NE(room, nullptr);
  const Scan scan = scan_of(*room, 0.12, 0.01, false);
  const auto imported = import(scan);
  ASSERT_TRUE(imported) << imported.error().message;
  const auto scene = scene_from(imported->scene);
  ASSERT_NE(scene, nullptr);
  std::map<std::string, int> kinds;
  for (const SceneObject& object : scene->objects()) {
    ++kinds[object.name.substr(0, object.name.find('_'))];
  }
  EXPECT_GE(kinds["floor"], 1) << remarks(*imported);
  EXPECT_GE(kinds["ceiling"], 1);
  EXPECT_GE(kinds["wall"], 4);
  const double share = matched_power(room, scene);
  RecordProperty("matched", fmt::format("{:.4f} of {} triangles", share, scan.triangles));
  RecordProperty("said", remarks(*imported));
  EXPECT_GE(share, 0.8) << remarks(*imported);
}

}  // namespace
}  // namespace rayloc::scan_test
