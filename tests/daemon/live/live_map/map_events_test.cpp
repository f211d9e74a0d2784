// Tests the events for a viewer of the map: a snapshot, then updates, and after a lost connection
// the missed messages.
#include "daemon/live/live_map/map_events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "rayloc/v1/envelope.pb.h"

namespace rayloc::map_events_test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class MapEventsTest : public ::testing::Test {
 protected:
  void put(const std::string& access_point) {
    v1::Envelope envelope;
    envelope.mutable_source()->set_access_point(access_point);
    board_->put("v1/source/room/" + access_point + "/", envelope, envelope.SerializeAsString());
  }
  static json data_of(const std::string& event) {
    const std::size_t begin = event.find("\ndata: ") + 7;
    return json::parse(event.substr(begin, event.find("\n\n") - begin));
  }
  static std::vector<std::string> names_in(const std::string& event) {
    std::vector<std::string> names;
    const json data = data_of(event);
    for (const json& message : data.at("messages")) {
      names.push_back(message.at("source").at("access_point"));
    }
    return names;
  }

  std::shared_ptr<MessageBoard> board_ = std::make_shared<MessageBoard>(1000);
  MapEvents events_{board_, 7, [] { return Timestamp(std::chrono::seconds(1)); }};
  EventCursor cursor_;
};

TEST_F(MapEventsTest, BeginWithASnapshotHoweverLittleThereIs) {
  const EventBatch nothing = events_.take(cursor_);
  EXPECT_THAT(nothing.text, StartsWith("retry: 1000\nevent: snapshot\nid: 7-0\ndata: {"));
  EXPECT_EQ(data_of(nothing.text),
            json({{"now", "1970-01-01T00:00:01Z"},
                  {"epoch", "7"},
                  {"resumed", false},
                  {"messages", json::array()}}));
  EXPECT_THAT(events_.take(cursor_).text, IsEmpty());
}

TEST_F(MapEventsTest, ContinueWithTheLatestValues) {
  put("a");
  put("b");
  EXPECT_THAT(names_in(events_.take(cursor_).text), ElementsAre("a", "b"));
  put("a");
  put("b");
  put("a");
  const EventBatch update = events_.take(cursor_);
  EXPECT_THAT(update.text, StartsWith("event: update\nid: 7-5\n"));
  EXPECT_THAT(names_in(update.text), ElementsAre("b", "a"));
  EXPECT_EQ(update.coalesced, 1U);
}

TEST_F(MapEventsTest, DoNotCountEventsBeforeAViewerConnected) {
  for (int i = 0; i < 50; ++i) {
    put("a");
  }
  EXPECT_EQ(events_.take(cursor_).coalesced, 0U);
}

TEST_F(MapEventsTest, ResumeWhereAViewerWas) {
  put("a");
  events_.take(cursor_);
  put("b");
  EventCursor again;
  again.last_event_id = "7-1";
  const std::string resumed = events_.take(again).text;
  EXPECT_TRUE(data_of(resumed).at("resumed"));
  EXPECT_THAT(names_in(resumed), ElementsAre("b"));
}

TEST_F(MapEventsTest, RestartForUnknownEventIds) {
  put("a");
  // Ids of another start, of the future, and invalid ones.
  for (const char* id : {"6-1", "7-2", "7-", "7-x", "7--1", "7-99999999999999999999", "garbage"}) {
    EventCursor again;
    again.last_event_id = id;
    const std::string event = events_.take(again).text;
    EXPECT_FALSE(data_of(event).at("resumed")) << id;
    EXPECT_THAT(names_in(event), ElementsAre("a")) << id;
  }
}

TEST_F(MapEventsTest, GiveALotInPieces) {
  for (int i = 0; i < 300; ++i) {
    put("ap" + std::to_string(i));
  }
  EXPECT_EQ(names_in(events_.take(cursor_).text).size(), 256U);
  const EventBatch rest = events_.take(cursor_);
  EXPECT_EQ(names_in(rest.text).size(), 44U);
  EXPECT_EQ(rest.coalesced, 0U);
}

}  // namespace
}  // namespace rayloc::map_events_test
