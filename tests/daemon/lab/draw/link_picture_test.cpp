#include "daemon/lab/draw/link_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::draw::link_picture_test {
namespace {

using ::testing::HasSubstr;

SceneSource meeting_room() {
  return *load_scene_source(test::data_path("/sites/meeting_room"), std::nullopt);
}

TEST(LinkPicture, ASiteHasItsAccessPoints) {
  const SceneSource source = meeting_room();
  const ScenePicture picture = source_picture(source);
  EXPECT_EQ(picture.title, "meeting_room");
  EXPECT_THAT(picture.caption, HasSubstr("5.19 GHz"));
  ASSERT_EQ(picture.marks.size(), 3U);
  EXPECT_EQ(picture.marks[0].name, "ap1");
  EXPECT_EQ(picture.marks[0].kind, MarkKind::kAccessPoint);
  EXPECT_EQ(picture.marks[0].antennas.size(), 3U);
  EXPECT_TRUE(picture.paths.empty());
}

TEST(LinkPicture, ALinkAddsItsStrongPathsAndTheEndsThatAreMarked) {
  const SceneSource source = meeting_room();
  DrawnLink link;
  link.transmitter.position = {0.5, 0.25, 1.2};
  link.receiver.position = {-1.0, -0.5, 1.2};
  link.marks_transmitter = true;
  link.options.max_depth = 2;
  ScenePicture all = source_picture(source);
  link.range_db = 300.0;
  add_link(link, source, all);
  ASSERT_FALSE(all.paths.empty());
  EXPECT_THAT(all.caption, HasSubstr("paths to depth 2"));
  ASSERT_EQ(all.marks.size(), 4U);
  EXPECT_EQ(all.marks.back().name, "tx");
  ScenePicture strong = source_picture(source);
  link.range_db = 3.0;
  add_link(link, source, strong);
  EXPECT_LT(strong.paths.size(), all.paths.size());
  EXPECT_DOUBLE_EQ(strong.weakest_db, strong.strongest_db - 3.0);
  for (const DrawnPath& path : strong.paths) {
    EXPECT_GE(path.power_db, strong.weakest_db);
    EXPECT_EQ(path.points.front(), link.transmitter.position);
    EXPECT_EQ(path.points.back(), link.receiver.position);
  }
  EXPECT_THAT(strong.caption, HasSubstr("within 3 dB are drawn"));
}

}  // namespace
}  // namespace rayloc::draw::link_picture_test
