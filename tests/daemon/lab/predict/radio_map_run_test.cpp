#include "daemon/lab/predict/radio_map_run.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::radio_map_run_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

SceneSource source_of(const std::string& path) {
  return *load_scene_source(test::data_path(path), std::nullopt);
}

TEST(RadioMapRun, MapsTheAccessPointsThatAreNamedOrAll) {
  const SceneSource site = source_of("/sites/meeting_room");
  EXPECT_EQ(mapped_access_points(site, {})->size(), 3U);
  const auto one = mapped_access_points(site, {"ap2"});
  ASSERT_TRUE(one);
  ASSERT_EQ(one->size(), 1U);
  EXPECT_EQ(one->front().name, "ap2");
  EXPECT_THAT(mapped_access_points(site, {"ap9"}).error().message, HasSubstr("--access-points"));
}

TEST(RadioMapRun, ASceneHasNoAccessPoints) {
  const SceneSource scene = source_of("/scenes/corridor/scene.xml");
  EXPECT_TRUE(mapped_access_points(scene, {})->empty());
  EXPECT_THAT(mapped_access_points(scene, {"ap1"}).error().message, HasSubstr("is a scene"));
}

TEST(RadioMapRun, TheGridCoversTheRoomAtTheHeightOfTheDevices) {
  const SceneSource site = source_of("/sites/meeting_room");
  const auto grid = mapped_grid(site, std::nullopt, 0.25);
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->count_x, 14U);
  EXPECT_DOUBLE_EQ(grid->first.z, 1.2);
  const auto usual = mapped_grid(site, std::nullopt, 0.0);
  ASSERT_TRUE(usual);
  EXPECT_DOUBLE_EQ(usual->step, 0.05);
  EXPECT_THAT(mapped_grid(site, 9.0, 0.25).error().message, HasSubstr("--height 9"));
  EXPECT_THAT(mapped_grid(site, std::nullopt, 1e-4).error().message, HasSubstr("--step"));
}

TEST(RadioMapRun, ReportsTheShareOfMappedAntennas) {
  const SceneSource scene = source_of("/scenes/corridor/scene.xml");
  TraceOptions options;
  options.max_depth = 0;
  std::vector<double> shares;
  Observer observer;
  observer.on_progress = [&](double share, const std::string&) { shares.push_back(share); };
  const RadioMaps maps = compute_radio_maps(
      scene,
      {planned_antenna({-8.0, 0.0, 2.2}, 1), planned_antenna({8.0, 0.0, 2.2}, 2)},
      *mapped_grid(scene, std::nullopt, 2.0),
      options,
      observer);
  EXPECT_THAT(shares, ElementsAre(0.5, 1.0));
  ASSERT_EQ(maps.maps.size(), 2U);
  EXPECT_EQ(maps.arrays[1].name, "antenna 2");
  EXPECT_EQ(maps.strongest.size(), maps.grid.size());
}

}  // namespace
}  // namespace rayloc::radio_map_run_test
