// Tests how the settings of method rayloc reach its tracks.
#include "daemon/methods/track_options.h"

#include <string>

#include <gtest/gtest.h>

#include "daemon/methods/method_registry.h"
#include "engine/track/track.h"

namespace rayloc::track_options_test {
namespace {

MethodOptions options_with(std::string_view tracks) {
  MethodOptions options;
  options.values.insert_or_assign(std::string(kTracksSetting), std::string(tracks));
  return options;
}

TEST(TrackOptions, TheGridFollowsUnlessACloudIsRequested) {
  EXPECT_FALSE(track_options({}).uses_cloud);
  EXPECT_FALSE(track_options(options_with(kGridTracks)).uses_cloud);
  EXPECT_TRUE(track_options(options_with(kCloudTracks)).uses_cloud);
  EXPECT_EQ(kTracksValues.front(), kGridTracks);
}

TEST(TrackOptions, TheWholeRoomIsComparedIfRequested) {
  EXPECT_FALSE(track_options({}).is_exhaustive);
  MethodOptions options;
  options.is_exhaustive = true;
  EXPECT_TRUE(track_options(options).is_exhaustive);
}

TEST(TrackOptions, OnlyMethodRaylocHasTheSetting) {
  for (const Method* method : methods()) {
    EXPECT_EQ(method->has_setting(kTracksSetting), method->name == "rayloc") << method->name;
  }
}

}  // namespace
}  // namespace rayloc::track_options_test
