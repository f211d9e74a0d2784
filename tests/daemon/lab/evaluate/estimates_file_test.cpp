#include "daemon/lab/evaluate/estimates_file.h"

#include <google/protobuf/util/delimited_message_util.h>
#include <gtest/gtest.h>

#include "daemon/messages/json.h"
#include "daemon/messages/proto_time.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::estimates_file_test {
namespace {

using namespace std::chrono_literals;

v1::Location location_at(Duration time) {
  v1::Location location;
  location.set_event_id("02:52:4c:00:00:01/" + std::to_string(time.count()) + "/snapshot");
  location.set_kind(v1::LOCATION_KIND_SNAPSHOT);
  *location.mutable_time() = to_proto(Timestamp(time));
  location.mutable_target()->set_kind(v1::TARGET_KIND_DEVICE);
  location.mutable_target()->set_mac("02:52:4c:00:00:01");
  location.set_mode(v1::FIX_MODE_2D);
  location.mutable_position()->set_x(1.5);
  for (const double value : {1, 0, 0, 0, 2, 0, 0, 0, 3}) {
    location.add_position_covariance(value);
  }
  v1::Hypothesis& hypothesis = *location.add_hypotheses();
  hypothesis.mutable_position()->set_y(-1);
  hypothesis.set_weight(0.5);
  location.set_residual_probability(0.5);
  return location;
}

void expect_two_estimates(const Expected<std::vector<PublishedEstimate>>& read) {
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2U);
  const PublishedEstimate& first = read->front();
  EXPECT_FALSE(first.person);
  EXPECT_FALSE(first.filtered);
  EXPECT_EQ(first.target, "02:52:4c:00:00:01");
  EXPECT_EQ(first.estimate.time, Timestamp(1s + 1ns));
  EXPECT_EQ(first.estimate.position, (Vec3d{1.5, 0, 0}));
  EXPECT_EQ(first.estimate.covariance[4], 2.0);
  ASSERT_EQ(first.estimate.hypotheses.size(), 1U);
  EXPECT_EQ(first.estimate.hypotheses[0].position.y, -1.0);
  EXPECT_EQ(first.estimate.residual_probability, 0.5);
  EXPECT_EQ(read->back().estimate.time, Timestamp(2s));
}

TEST(EstimatesFile, ReadsLocationsAsJsonLines) {
  expect_two_estimates(read_estimates(
      *to_json(location_at(1s + 1ns)) + "\n\n" + *to_json(location_at(2s)) + "\r\n", "e"));
}

TEST(EstimatesFile, RecognisesEstimatesWithoutUncertainty) {
  v1::Location location = location_at(1s);
  EXPECT_TRUE(read_estimates(*to_json(location), "e")->front().estimate.is_uncertainty_stated);
  location.clear_hypotheses();
  EXPECT_TRUE(read_estimates(*to_json(location), "e")->front().estimate.is_uncertainty_stated);
  location.clear_position_covariance();
  EXPECT_FALSE(read_estimates(*to_json(location), "e")->front().estimate.is_uncertainty_stated);
}

TEST(EstimatesFile, ReadsEnvelopesAndSkipsOtherMessages) {
  v1::Envelope envelope;
  *envelope.mutable_location() = location_at(1s + 1ns);
  std::string lines = *to_json(envelope) + "\n";
  envelope.mutable_heartbeat()->set_epoch(1);
  lines += *to_json(envelope) + "\n";
  *envelope.mutable_location() = location_at(2s);
  lines += *to_json(envelope);
  expect_two_estimates(read_estimates(lines, "e"));
}

TEST(EstimatesFile, ReadsDelimitedProtobuf) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    for (const Duration time : {Duration(1s + 1ns), Duration(2s)}) {
      ASSERT_TRUE(
          google::protobuf::util::SerializeDelimitedToZeroCopyStream(location_at(time), &stream));
    }
  }
  expect_two_estimates(read_estimates(bytes, "e"));
  const auto cut = read_estimates(bytes.substr(0, bytes.size() - 1), "e.pb");
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().message,
            "e.pb: byte " + std::to_string(location_at(1s + 1ns).ByteSizeLong() + 2) +
                ": cut off, or neither JSON lines nor Locations in protobuf");
}

TEST(EstimatesFile, ANoFixHasNoPosition) {
  v1::Location location = location_at(1s);
  location.set_mode(v1::FIX_MODE_NO_FIX);  // regardless of its other fields
  const auto read = read_estimates(*to_json(location), "e");
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->front().estimate.position);
  location.clear_position();
  location.set_mode(v1::FIX_MODE_2D);
  EXPECT_FALSE(read_estimates(*to_json(location), "e")->front().estimate.position);
}

TEST(EstimatesFile, ErrorsNameFileLineAndColumn) {
  const std::string good = *to_json(location_at(1s)) + "\n";
  EXPECT_EQ(read_estimates(good + "{\"time\":}", "e.jsonl").error().message,
            "e.jsonl:2:9: not JSON");
  EXPECT_EQ(read_estimates(good + "[1]", "e.jsonl").error().message,
            "e.jsonl:2:1: not a JSON object");
  EXPECT_EQ(read_estimates("{}", "e.jsonl").error().message,
            "e.jsonl:1:1: a Location without a time");
  EXPECT_EQ(read_estimates(R"({"time":"yesterday"})", "e.jsonl")
                .error()
                .message.rfind("e.jsonl:1:1: not a Location or an Envelope: ", 0),
            0U);
  v1::Location location = location_at(1s);
  location.mutable_position()->set_x(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(read_estimates(*to_json(location), "e.jsonl"));
  location = location_at(1s);
  location.add_position_covariance(1.0);
  EXPECT_FALSE(read_estimates(*to_json(location), "e.jsonl"));
}

TEST(EstimatesFile, ReportsAnUnreadableFile) {
  EXPECT_EQ(load_estimates("/nowhere").error().message, "/nowhere: cannot be read");
  EXPECT_FALSE(load_estimates("/tmp"));
  EXPECT_TRUE(read_estimates("", "e")->empty());
}

}  // namespace
}  // namespace rayloc::estimates_file_test
