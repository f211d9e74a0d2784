// Tests the output of `rayloc sub` and its message filter.
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/cli/feed/feed_writer.h"
#include "daemon/cli/feed/message_filter.h"

namespace rayloc::cli::feed_test {
namespace {

v1::Envelope parsed(const std::string& text) {
  v1::Envelope envelope;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &envelope)) << text;
  return envelope;
}

v1::Envelope location() {
  return parsed(R"(location {
    kind: LOCATION_KIND_FILTERED
    target { mac: "02:00:00:00:00:01" name: "phone" }
    position { x: 1 y: 2 z: 1.2 }
    accuracy_m: 0.5
    hypotheses { weight: 0.75 position { x: 1 y: 2 } } hypotheses { weight: 0.125 position { x: 3 } }
    zones { zone: "desk" probability: 0.75 } zones { zone: "door" probability: 0.125 }
  })");
}
v1::Envelope zone_event() {
  return parsed(
      R"(zone { zone: "door" kind: ZONE_EVENT_KIND_LEFT target { track: 2 } occupancy: 1
                dwell { seconds: 4 nanos: 500000000 } reason: "its track was lost" })");
}
v1::Envelope heartbeat() { return parsed("heartbeat {}"); }

TEST(MessageFilter, PassesEverythingUnlessAsked) {
  for (const v1::Envelope& each : {location(), zone_event(), heartbeat()}) {
    EXPECT_TRUE(MessageFilter{}.passes(each));
  }
}

TEST(MessageFilter, MatchesTargetsByTopicAndByName) {
  for (const char* wanted : {"02:00:00:00:00:01", "phone"}) {
    const MessageFilter filter{.targets = {"someone", wanted}};
    EXPECT_TRUE(filter.passes(location()));
    EXPECT_FALSE(filter.passes(zone_event()));
    EXPECT_FALSE(filter.passes(heartbeat()));
  }
  EXPECT_TRUE(MessageFilter{.targets = {"person-2"}}.passes(zone_event()));
  // A target without a name is not the one called "".
  EXPECT_FALSE(MessageFilter{.targets = {""}}.passes(zone_event()));
}

TEST(MessageFilter, MatchesKindAccuracyAndConfidenceOfLocations) {
  EXPECT_TRUE(MessageFilter{.kind = "filtered"}.passes(location()));
  EXPECT_FALSE(MessageFilter{.kind = "snapshot"}.passes(location()));
  EXPECT_FALSE(MessageFilter{.kind = "snapshot"}.passes(zone_event()));
  EXPECT_TRUE(MessageFilter{.max_accuracy = 0.5}.passes(location()));
  EXPECT_FALSE(MessageFilter{.max_accuracy = 0.49}.passes(location()));
  EXPECT_TRUE(MessageFilter{.min_confidence = 0.75}.passes(location()));
  EXPECT_FALSE(MessageFilter{.min_confidence = 0.76}.passes(location()));
  // Core and foot of one place count together.
  const v1::Envelope two = parsed(R"(location {
      hypotheses { weight: 0.5 position { x: 1 } } hypotheses { weight: 0.25 position { x: 1.2 } }
      hypotheses { weight: 0.25 position { x: 1.4 } } })");
  EXPECT_TRUE(MessageFilter{.min_confidence = 0.75}.passes(two));
  EXPECT_FALSE(MessageFilter{.min_confidence = 0.76}.passes(two));
  // A location without an accuracy passes no limit of the accuracy.
  EXPECT_FALSE(MessageFilter{.max_accuracy = 100.0}.passes(parsed("location {}")));
  EXPECT_FALSE(MessageFilter{.min_confidence = 0.0}.passes(heartbeat()));
}

TEST(MessageFilter, MatchesZonesOfLocationsAndEvents) {
  EXPECT_TRUE(MessageFilter{.zones = {"desk"}}.passes(location()));
  EXPECT_FALSE(MessageFilter{.zones = {"door"}}.passes(location()));
  MessageFilter often{.zones = {"door"}};
  often.zone_probability = 0.1;
  EXPECT_TRUE(often.passes(location()));
  EXPECT_TRUE(MessageFilter{.zones = {"door"}}.passes(zone_event()));
  EXPECT_FALSE(MessageFilter{.zones = {"desk"}}.passes(zone_event()));
  MessageFilter both{.targets = {"phone"}, .zones = {"desk"}};
  EXPECT_TRUE(both.passes(location()));
  both.targets = {"tablet"};
  EXPECT_FALSE(both.passes(location()));
}

TEST(FeedWriter, DescribesAZoneEvent) {
  FeedWriter writer(FeedFormat::kText);
  writer.add(zone_event());
  EXPECT_EQ(
      writer.next(),
      "00:00:00.000  zone       person-2 left door after 4.5 s, 1 inside: its track was lost");
  EXPECT_FALSE(writer.next());
}

TEST(FeedWriter, NamesTheMethodThatIsCompared) {
  const v1::Envelope compared = parsed(R"(sent { seconds: 0 } compared {
      target { mac: "02:52:4c:00:00:01" } kind: LOCATION_KIND_SNAPSHOT
      position { x: 1 y: 2 z: 3 } quality { method: "spotfi" } })");
  FeedWriter writer(FeedFormat::kText);
  writer.add(compared);
  const std::string text = writer.next().value_or("");
  EXPECT_NE(text.find("compared   02:52:4c:00:00:01 snapshot: 1.00, 2.00, 3.00 m"),
            std::string::npos)
      << text;
  EXPECT_TRUE(text.ends_with(", by spotfi")) << text;
  EXPECT_TRUE(MessageFilter{.targets = {"02:52:4c:00:00:01"}}.passes(compared));
  EXPECT_FALSE(MessageFilter{.kind = "snapshot"}.passes(compared)) << "of locations alone";
  FeedWriter csv(FeedFormat::kCsv);
  csv.add(compared);
  EXPECT_EQ(csv.without_form(), 1U);
}

TEST(FeedWriter, ListsAmbiguityAndWarnings) {
  v1::Envelope suspect = location();
  v1::Quality& quality = *suspect.mutable_location()->mutable_quality();
  quality.set_ambiguous(true);
  quality.add_warnings("beside the transmitter");
  quality.add_warnings("ap1 is covered");
  FeedWriter writer(FeedFormat::kText);
  writer.add(suspect);
  const std::string text = writer.next().value_or("");
  EXPECT_TRUE(
      text.ends_with(", ambiguous; warning: beside the transmitter; warning: ap1 is covered"))
      << text;
}

TEST(FeedWriter, HoldsGeojsonUntilAHeartbeatGivesTheGeoreference) {
  FeedWriter writer(FeedFormat::kGeojson);
  writer.add(location());
  writer.add(zone_event());
  EXPECT_FALSE(writer.next());
  const v1::Heartbeat with_place =
      parsed("heartbeat { georeference { latitude_deg: 50 longitude_deg: 8 } }").heartbeat();
  ASSERT_TRUE(writer.receive(with_place));
  const auto feature = nlohmann::json::parse(writer.next().value());
  EXPECT_NEAR(feature.at("geometry").at("coordinates").at(0).get<double>(), 8.0, 1e-4);
  EXPECT_FALSE(writer.next());
  EXPECT_EQ(writer.without_form(), 1U);
}

TEST(FeedWriter, RefusesGeojsonWithoutAPlace) {
  FeedWriter writer(FeedFormat::kGeojson);
  const auto received = writer.receive(v1::Heartbeat());
  ASSERT_FALSE(received);
  EXPECT_EQ(received.error().kind, ErrorKind::kConfiguration);
  EXPECT_NE(received.error().message.find("[georeference]"), std::string::npos);
}

TEST(FeedWriter, WritesOmloxInLocalMetresWithoutAPlace) {
  FeedWriter writer(FeedFormat::kOmlox);
  ASSERT_TRUE(writer.receive(v1::Heartbeat()));
  writer.add(parsed("location { mode: FIX_MODE_NO_FIX }"));
  writer.add(location());
  EXPECT_EQ(nlohmann::json::parse(writer.next().value()).at("crs"), "local");
  EXPECT_EQ(writer.without_form(), 1U);  // no position, no omlox Location
}

TEST(FeedWriter, HoldsNoMoreThanItsLimitAndCountsTheRest) {
  FeedWriter writer(FeedFormat::kOmlox);
  for (std::size_t i = 0; i < FeedWriter::kMaxHeld + 5; ++i) {
    writer.add(location());
  }
  EXPECT_EQ(writer.dropped(), 5U);
}

TEST(FeedWriter, CsvBeginsWithItsHeader) {
  FeedWriter writer(FeedFormat::kCsv);
  EXPECT_EQ(writer.header().value().substr(0, 12), "time,site,ta");
  EXPECT_FALSE(FeedWriter(FeedFormat::kJson).header());
  writer.add(location());
  EXPECT_NE(writer.next().value().find(",1.0,2.0,1.2,0.5,"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::cli::feed_test
