#include "daemon/messages/location_formats.h"

#include <algorithm>

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "rayloc/v1/envelope.pb.h"

namespace rayloc::location_formats_test {
namespace {

using Json = nlohmann::json;

v1::Envelope envelope() {
  v1::Envelope envelope;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      R"(sent { seconds: 1718000958 nanos: 640000000 }
         location {
           event_id: "e1"
           kind: LOCATION_KIND_FILTERED
           time { seconds: 1718000958 nanos: 533000000 }
           target { kind: TARGET_KIND_DEVICE mac: "02:52:4c:00:00:01" name: "the \"blue\" phone" }
           frame { crs: "local" site: "office" floor: -0.5 }
           mode: FIX_MODE_2D
           position { x: 0.1 y: -0.875 z: 1.2 }
           accuracy_m: 0.5 accuracy_confidence: 0.95
           residual_probability: 0.125
           velocity { x: 3 y: 4 }
           track_state: TRACK_STATE_CONFIRMED
           zones { zone: "desk" probability: 0.75 } zones { zone: "door" probability: 0 }
           quality { frames: 12 }
         })",
      &envelope));
  return envelope;
}

v1::Envelope no_fix() {
  v1::Envelope envelope;
  v1::Location& location = *envelope.mutable_location();
  location.set_event_id("e2");
  location.mutable_target()->set_track(3);
  location.mutable_target()->set_kind(v1::TARGET_KIND_PERSON);
  location.set_mode(v1::FIX_MODE_NO_FIX);
  location.set_residual_probability(1.0);
  location.mutable_quality()->set_no_fix_reason("one antenna, no ratio");
  return envelope;
}

v1::Georeference berlin() {
  v1::Georeference site;
  site.set_latitude_deg(52.52);
  site.set_longitude_deg(13.405);
  site.set_altitude_m(35.0);
  site.set_rotation_deg(90.0);
  return site;
}

TEST(LocationFormats, CsvQuotesAndLeavesAbsentValuesEmpty) {
  EXPECT_EQ(csv_header(),
            "time,site,target,name,kind,mode,x_m,y_m,z_m,accuracy_m,accuracy_confidence,"
            "residual_probability,velocity_x_m_s,velocity_y_m_s,track_state,zones,frames,"
            "no_fix_reason");
  EXPECT_EQ(to_csv(envelope()),
            "2024-06-10T06:29:18.533Z,office,02:52:4c:00:00:01,\"the \"\"blue\"\" phone\","
            "filtered,2d,0.1,-0.875,1.2,0.5,0.95,0.125,3.0,4.0,confirmed,desk=0.75;door=0.0,12,");
  EXPECT_EQ(to_csv(no_fix()),
            "1970-01-01T00:00:00Z,,person-3,,unspecified,no_fix,,,,,,1.0,,,,,0,"
            "\"one antenna, no ratio\"");
}

TEST(LocationFormats, GeojsonIsAFeatureOfRfc7946) {
  const Json feature = Json::parse(to_geojson(envelope(), berlin()));
  EXPECT_EQ(feature.at("type"), "Feature");
  EXPECT_EQ(feature.at("id"), "e1");
  EXPECT_EQ(feature.at("geometry").at("type"), "Point");
  const Json& coordinates = feature.at("geometry").at("coordinates");
  ASSERT_EQ(coordinates.size(), 3U);
  // +x looks north and +y west; a degree is 111,278 m of latitude and 67,880 m of longitude there.
  EXPECT_NEAR(coordinates.at(0).get<double>(), 13.405 + 0.875 / 67'879.78, 1e-9);
  EXPECT_NEAR(coordinates.at(1).get<double>(), 52.52 + 0.1 / 111'277.0, 1e-10);
  EXPECT_NEAR(coordinates.at(2).get<double>(), 36.2, 1e-5);
  const Json& properties = feature.at("properties");
  EXPECT_EQ(properties.at("target"), "02:52:4c:00:00:01");
  EXPECT_EQ(properties.at("name"), "the \"blue\" phone");
  EXPECT_EQ(properties.at("kind"), "filtered");
  EXPECT_EQ(properties.at("track_state"), "confirmed");
  EXPECT_EQ(properties.at("accuracy_m"), 0.5);
  EXPECT_EQ(properties.at("zones").at("desk"), 0.75);
  EXPECT_EQ(properties.at("floor"), -0.5);
  EXPECT_EQ(properties.at("speed_m_s"), 5.0);
  EXPECT_NEAR(properties.at("course_deg").get<double>(), 306.8699, 1e-3);
}

TEST(LocationFormats, GeojsonOfNoFixIsUnlocated) {
  const Json feature = Json::parse(to_geojson(no_fix(), berlin()));
  EXPECT_TRUE(feature.at("geometry").is_null());
  EXPECT_EQ(feature.at("properties").at("target"), "person-3");
  EXPECT_EQ(feature.at("properties").at("no_fix_reason"), "one antenna, no ratio");
}

TEST(LocationFormats, OmloxIsALocationOfTheHub) {
  const v1::Georeference site = berlin();
  const auto line = to_omlox(envelope(), &site);
  ASSERT_TRUE(line);
  const Json json = Json::parse(*line);
  EXPECT_EQ(json.at("crs"), "EPSG:4326");
  EXPECT_NEAR(json.at("position").at("coordinates").at(1).get<double>(), 52.520001, 1e-6);
  EXPECT_EQ(json.at("position").at("coordinates").at(2), 1.2);
  EXPECT_EQ(json.at("elevation_ref"), "floor");
  EXPECT_EQ(json.at("provider_type"), "wifi");
  EXPECT_EQ(json.at("provider_id"), "02524CFFFE000001");
  EXPECT_EQ(json.at("source"), "office");
  EXPECT_EQ(json.at("timestamp_generated"), "2024-06-10T06:29:18.533Z");
  EXPECT_EQ(json.at("timestamp_sent"), "2024-06-10T06:29:18.640Z");
  EXPECT_EQ(json.at("accuracy"), 0.5);
  EXPECT_EQ(json.at("floor"), -0.5);
  EXPECT_EQ(json.at("speed"), 5.0);
  EXPECT_NEAR(json.at("course").get<double>(), 306.8699, 1e-3);
  EXPECT_EQ(json.at("properties").at("zones").at("desk"), 0.75);
}

TEST(LocationFormats, OmloxIsLocalWithoutAGeoreference) {
  const Json json = Json::parse(to_omlox(envelope(), nullptr).value());
  EXPECT_EQ(json.at("crs"), "local");
  EXPECT_EQ(json.at("position").at("coordinates"), Json({0.1, -0.875, 1.2}));
  EXPECT_FALSE(json.contains("course"));  // from true north
  EXPECT_FALSE(to_omlox(no_fix(), nullptr));
}

TEST(LocationFormats, NamesThatAreNoTextBreakNoLine) {
  v1::Envelope strange = envelope();
  strange.mutable_location()->mutable_target()->set_name("a\nb,\xff");
  const Json feature = Json::parse(to_geojson(strange, berlin()));
  EXPECT_EQ(feature.at("properties").at("name"), "a\nb,\xef\xbf\xbd");
  EXPECT_EQ(to_geojson(strange, berlin()).find('\n'), std::string::npos);
  EXPECT_NE(to_csv(strange).find("\"a\nb,\xff\""), std::string::npos);
}

}  // namespace
}  // namespace rayloc::location_formats_test
