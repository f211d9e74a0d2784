// Tests the screen of `rayloc top` for a daemon with several sites.
#include "daemon/cli/feed/top_sites.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

namespace rayloc::cli::top_sites_test {
namespace {

using ::testing::Contains;
using ::testing::Not;

constexpr TopModel::Clock::time_point kNow{std::chrono::seconds(1000)};

PublishedMessage message(const std::string& site, const std::string& text) {
  v1::Envelope envelope;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &envelope)) << text;
  return {"v1/heartbeat/" + site + "/", envelope.SerializeAsString()};
}

PublishedMessage heartbeat(const std::string& site, int time) {
  return message(site,
                 "epoch: 1 sequence: " + std::to_string(time) +
                     " heartbeat { time { seconds: " + std::to_string(time) + " } }");
}

TEST(TopSites, ShowsEachSiteWithItsName) {
  TopSites sites("");
  sites.add(heartbeat("office", 1), kNow);
  EXPECT_THAT(sites.lines(kNow), Not(Contains("site office")));
  sites.add(heartbeat("lab%202", 1), kNow);
  EXPECT_THAT(sites.lines(kNow), Contains("site office"));
  EXPECT_THAT(sites.lines(kNow), Contains("site lab 2"));
}

TEST(TopSites, ShowsTheRequestedSiteAlone) {
  TopSites sites("lab 2");
  sites.add(heartbeat("office", 1), kNow);
  EXPECT_TRUE(sites.has_heartbeat());
  EXPECT_FALSE(sites.has_shown_site());
  sites.add(heartbeat("lab%202", 1), kNow);
  EXPECT_TRUE(sites.has_shown_site());
  EXPECT_THAT(sites.lines(kNow), Not(Contains("site office")));
}

TEST(TopSites, IsCompleteAfterTheHeartbeatsOrTheFarewellOfEachShownSite) {
  TopSites all("");
  EXPECT_FALSE(all.is_complete(2));
  all.add({"v1/heartbeat/office/", "\xff"}, kNow);
  EXPECT_FALSE(all.has_heartbeat());
  TopSites one("office");
  for (int time = 1; time <= 2; ++time) {
    all.add(heartbeat("office", time), kNow);
    one.add(heartbeat("office", time), kNow);
  }
  EXPECT_TRUE(all.is_complete(2));
  all.add(heartbeat("lab", 1), kNow);
  one.add(heartbeat("lab", 1), kNow);
  EXPECT_FALSE(all.is_complete(2));
  EXPECT_TRUE(one.is_complete(2));
  all.add(message("lab", "epoch: 1 sequence: 2 goodbye { reason: 'SIGTERM' }"), kNow);
  EXPECT_TRUE(all.is_complete(2));
}

}  // namespace
}  // namespace rayloc::cli::top_sites_test
