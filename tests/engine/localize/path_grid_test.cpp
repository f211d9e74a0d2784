#include "engine/localize/path_grid.h"
#include "engine/grid/grid.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>

#include "engine/localize/localizer.h"
#include "engine/scene/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::path_grid_test {
namespace {

class MemoryStore : public PathGridStore {
 public:
  std::optional<std::string> load(const std::string& key) override {
    ++loads;
    const auto found = kept.find(key);
    return found == kept.end() ? std::nullopt : std::optional(found->second);
  }
  void save(const std::string& key, std::string_view bytes) override {
    ++saves;
    kept[key] = bytes;
  }
  void refuse(const std::string& /*key*/) override { ++refusals; }

  std::map<std::string, std::string> kept;
  int loads = 0;
  int saves = 0;
  int refusals = 0;
};

Ray ray_of(double length) {
  Ray ray;
  ray.amplitude = {0.5, -0.25 * length};
  ray.length = length;
  ray.at_array = {0.6, 0.8, 0.0};
  ray.at_device = {-0.6, 0.8, 0.0};
  ray.reflections = 2;
  ray.cos2_incidence = 0.3;
  return ray;
}

// Cells of 0, 1, 2, 0 ... rays. They are asked for from several threads.
PathGridSource source(std::size_t cells, std::atomic<int>& traced) {
  return {cells, [&traced](std::size_t cell) {
            ++traced;
            std::vector<Ray> rays;
            for (std::size_t i = 0; i < cell % 3; ++i) {
              rays.push_back(ray_of(1.0 + 0.1 * static_cast<double>(cell + i)));
            }
            return rays;
          }};
}

PathGrid small_grid() {
  std::atomic<int> traced = 0;
  return make_path_grid(source(100, traced), "key", nullptr);
}

TEST(PathGrid, ComesBackFromItsBytes) {
  const PathGrid grid = small_grid();
  const auto back = parse_path_grid(to_bytes(grid));
  ASSERT_TRUE(back);
  EXPECT_TRUE(is_same(*back, grid));
}

TEST(PathGrid, BytesThatAreCutOffOrTooManyAreNone) {
  const std::string bytes = to_bytes(small_grid());
  for (std::size_t size = 0; size < bytes.size(); size += 13) {
    EXPECT_FALSE(parse_path_grid(std::string_view(bytes).substr(0, size))) << size;
  }
  EXPECT_FALSE(parse_path_grid(bytes + "x"));
  // A number of rays that no memory holds.
  std::string huge = bytes;
  huge.replace(8, 8, "\xff\xff\xff\xff\xff\xff\xff\x7f");
  EXPECT_FALSE(parse_path_grid(huge));
}

TEST(PathGrid, IsTracedOnceAndThenAFewCells) {
  MemoryStore store;
  std::atomic<int> first = 0;
  const PathGrid made = make_path_grid(source(1000, first), "key", &store);
  EXPECT_EQ(first, 1000);
  EXPECT_EQ(store.saves, 1);
  std::atomic<int> second = 0;
  EXPECT_TRUE(is_same(make_path_grid(source(1000, second), "key", &store), made));
  EXPECT_GT(second, 10);
  EXPECT_LT(second, 50);
  EXPECT_EQ(store.saves, 1);
  EXPECT_EQ(store.refusals, 0);
}

TEST(PathGrid, RefusesAndReplacesGridsOfOtherPrograms) {
  const PathGrid right = small_grid();
  PathGrid wrong = right;
  for (auto& rays : wrong) {
    for (Ray& ray : rays) {
      ray.amplitude *= 1.0 + 1e-15;
    }
  }
  const PathGrid short_one(right.begin(), right.end() - 1);
  for (const std::string& bytes : {to_bytes(wrong), to_bytes(short_one), std::string("rubbish")}) {
    MemoryStore store;
    store.kept["key"] = bytes;
    std::atomic<int> traced = 0;
    EXPECT_TRUE(is_same(make_path_grid(source(100, traced), "key", &store), right));
    EXPECT_EQ(store.refusals, 1);
    EXPECT_EQ(store.saves, 1);
    const auto kept = parse_path_grid(store.kept["key"]);
    EXPECT_TRUE(kept && is_same(*kept, right));
  }
}

TEST(PathGrid, KeyDependsOnEveryInputOfTheRays) {
  const RoomModel room = test::make_room();
  const Grid grid(room.bounds_min, room.bounds_max, room.device.height, 0.05);
  const auto key = [&](auto change) {
    RoomModel changed = room;
    Grid cells = grid;
    std::size_t most = 64;
    change(changed, cells, most);
    return path_grid_key(changed, changed.access_points[0], cells, most);
  };
  const std::string same = key([](RoomModel&, Grid&, std::size_t&) {});
  EXPECT_EQ(same, key([](RoomModel& r, Grid&, std::size_t&) {
              // These are no business of the rays.
              r.name = "other";
              r.likelihood_exponent = 0.1;
              r.access_points[0].gains = {};
              r.access_points[1].array.pose.position.x += 0.1;
            }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) {
              r.scene = test::make_scene({{"floor", test::box_mesh({-2, -2, -0.1}, {2, 2, 0})}},
                                         test::kConcrete);
            }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) {
              r.surface_correction.assign(r.scene->surfaces().size(), 0.9);
            }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) { r.trace.max_depth = 1; }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) { r.trace.transmission = true; }));
  const std::string edges =
      key([](RoomModel& r, Grid&, std::size_t&) { r.trace.diffraction = true; });
  EXPECT_NE(same, edges);
  EXPECT_NE(edges, key([](RoomModel& r, Grid&, std::size_t&) {
              r.trace.diffraction = r.trace.double_diffraction = true;
            }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) { r.trace.diffuse = true; }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) {
              r.device.pattern = AntennaPattern::kIsotropic;
            }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) {
              r.access_points[0].array.pose.position.x += 1e-9;
            }));
  EXPECT_NE(same, key([](RoomModel& r, Grid&, std::size_t&) {
              r.access_points[0].array.pose.orientation.yaw += 1e-9;
            }));
  EXPECT_NE(same, key([](RoomModel&, Grid& cells, std::size_t&) { cells.first.z += 0.01; }));
  EXPECT_NE(same, key([](RoomModel&, Grid&, std::size_t& most) { most = 32; }));
}

TEST(PathGrid, LocalizerIsTheSameToTheBitWithAStoreAndWithout) {
  const auto room = std::make_shared<const RoomModel>(test::make_room());
  const auto store = std::make_shared<MemoryStore>();
  LocalizerOptions kept;
  kept.path_grids = store;
  const auto without = Localizer::create(room, {});
  const auto saving = Localizer::create(room, kept);
  const auto loading = Localizer::create(room, kept);
  ASSERT_TRUE(without && saving && loading);
  EXPECT_EQ(store->loads, 6);
  EXPECT_EQ(store->saves, 3);
  EXPECT_EQ(store->refusals, 0);
  const auto frames = test::frames_at(*room, {0.3, 0.2, 1.2});
  const auto map = without->evidence(without->receive(frames)).log_likelihood;
  EXPECT_EQ(saving->evidence(saving->receive(frames)).log_likelihood, map);
  EXPECT_EQ(loading->evidence(loading->receive(frames)).log_likelihood, map);
  EXPECT_EQ(loading->locate(frames).position, without->locate(frames).position);
  EXPECT_EQ(loading->locate(frames).model_residual_db, without->locate(frames).model_residual_db);
}

}  // namespace
}  // namespace rayloc::path_grid_test
