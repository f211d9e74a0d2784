#include "daemon/messages/json.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/messages/proto_time.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc::json_test {
namespace {

using namespace std::chrono_literals;

TEST(Json, KeepsFieldNamesAndPrintsZeros) {
  v1::Location location;
  location.set_mode(v1::FIX_MODE_2D);
  location.mutable_position()->set_x(0.1);
  location.set_accuracy_m(0.0);
  *location.mutable_time() = to_proto(Timestamp(1718000958s + 500ms));
  const auto json = to_json(location);
  ASSERT_TRUE(json);
  EXPECT_EQ(json->find('\n'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(*json), nlohmann::json::parse(R"({
    "event_id": "", "kind": "LOCATION_KIND_UNSPECIFIED", "time": "2024-06-10T06:29:18.500Z",
    "mode": "FIX_MODE_2D", "position": {"x": 0.1, "y": 0, "z": 0}, "position_covariance": [],
    "accuracy_m": 0, "hypotheses": [], "residual_probability": 0,
    "track_state": "TRACK_STATE_UNSPECIFIED", "zones": []})"));
}

TEST(Json, NumbersSurviveTheRoundTrip) {
  v1::Point point;
  point.set_x(0.1 + 0.2);
  point.set_y(-1.0 / 3.0);
  point.set_z(5e-324);
  v1::Point back;
  ASSERT_TRUE(from_json(*to_json(point), back));
  EXPECT_EQ(back.x(), point.x());
  EXPECT_EQ(back.y(), point.y());
  EXPECT_EQ(back.z(), point.z());
}

TEST(Json, RefusesInvalidTextAndIgnoresUnknownFields) {
  v1::Point point;
  EXPECT_TRUE(from_json(R"({"x":1,"from_the_future":[1,2]})", point));
  EXPECT_EQ(point.x(), 1.0);
  EXPECT_FALSE(from_json(R"({"x":)", point));
  EXPECT_FALSE(from_json(R"({"x":"far"})", point));
  EXPECT_FALSE(from_json("", point));
}

TEST(Json, ATimeThatHasNoFormIsAnError) {
  v1::Location location;
  location.mutable_time()->set_seconds(1'000'000'000'000);
  EXPECT_FALSE(to_json(location));
}

TEST(ProtoTime, KeepsEveryNanosecond) {
  for (const Timestamp time : {Timestamp(0ns),
                               Timestamp(1718000958s + 1ns),
                               Timestamp(-1ns),
                               Timestamp(-1718000958s + 999999999ns)}) {
    EXPECT_EQ(from_proto(to_proto(time)), time);
    EXPECT_GE(to_proto(time).nanos(), 0);
  }
  EXPECT_EQ(to_proto(Duration(-1500ms)).seconds(), -1);
  EXPECT_EQ(to_proto(Duration(-1500ms)).nanos(), -500'000'000);
}

TEST(ProtoTime, BoundsReceivedTimes) {
  google::protobuf::Timestamp far;
  far.set_seconds(253'402'300'799);
  EXPECT_GT(from_proto(far), Timestamp(9'000'000'000s));
  far.set_seconds(-253'402'300'799);
  EXPECT_LT(from_proto(far), Timestamp(-9'000'000'000s));
}

}  // namespace
}  // namespace rayloc::json_test
