#include "daemon/messages/topic.h"

#include <gtest/gtest.h>

#include "daemon/messages/location.h"
#include "rayloc/v1/target.pb.h"

namespace rayloc::topic_test {
namespace {

TEST(Topic, EndsInASlash) {
  EXPECT_EQ(make_topic("heartbeat", "office"), "v1/heartbeat/office/");
  EXPECT_EQ(make_topic("location", "office", "02:52:4c:00:00:01"),
            "v1/location/office/02:52:4c:00:00:01/");
  EXPECT_EQ(compared_topic("2nd floor", "spotfi", "person-1"),
            "v1/compared/2nd%20floor/spotfi/person-1/");
}

TEST(Topic, EscapesSeparatorsAndControlCharacters) {
  EXPECT_EQ(make_topic("zone", "2nd floor", "a/b%\n"), "v1/zone/2nd%20floor/a%2Fb%25%0A/");
  EXPECT_EQ(make_topic("track", "B\xc3\xbcro"), "v1/track/B%C3%BCro/");
}

TEST(Topic, PrefixIsClassAndSite) {
  EXPECT_EQ(topic_prefix("v1/location/office/a/"), "v1/location/office/");
  EXPECT_EQ(topic_prefix("v1/track/office/"), "v1/track/office/");
  EXPECT_EQ(topic_prefix("v1/"), "v1/");
}

TEST(Topic, NamesTargetsByAddressThenHashThenTrack) {
  v1::Target target;
  EXPECT_EQ(target_component(target), "");
  target.set_track(7);
  EXPECT_EQ(target_component(target), "person-7");
  target.set_hashed_mac("c0ffee");
  EXPECT_EQ(target_component(target), "c0ffee");
  target.set_mac("02:52:4c:00:00:01");
  EXPECT_EQ(target_component(target), "02:52:4c:00:00:01");
}

TEST(Topic, NamesATargetAsItsMessage) {
  Target target;
  EXPECT_EQ(target_component(target), "");
  target.track = 7;
  EXPECT_EQ(target_component(target), "person-7");
  target.address = "c0ffee";
  EXPECT_EQ(target_component(target), "c0ffee");
}

}  // namespace
}  // namespace rayloc::topic_test
