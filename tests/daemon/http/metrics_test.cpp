#include "daemon/http/metrics.h"

#include <google/protobuf/descriptor.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {
namespace {

using ::testing::HasSubstr;

// Sets every number of the message to the next of 1, 2, 3 ...; returns how many there are.
int number_all(google::protobuf::Message& message, int next) {
  const auto* descriptor = message.GetDescriptor();
  for (int i = 0; i < descriptor->field_count(); ++i) {
    const auto* field = descriptor->field(i);
    if (!field->is_repeated() &&
        field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_UINT64) {
      message.GetReflection()->SetUInt64(&message, field, static_cast<std::uint64_t>(next++));
    }
  }
  return next;
}

TEST(Metrics, HoldEveryCounterOfTheHeartbeat) {
  v1::Heartbeat heartbeat;
  int next = number_all(*heartbeat.mutable_estimation(), 1001);
  next = number_all(*heartbeat.mutable_tracker(), next);
  next = number_all(*heartbeat.mutable_person_tracker(), next);
  next = number_all(*heartbeat.mutable_recorder(), next);
  next = number_all(*heartbeat.mutable_publisher(), next);
  v1::SourceReport& source = *heartbeat.add_sources();
  source.set_access_point("ap \"1\"\n");
  next = number_all(*source.mutable_counters(), next);
  (*source.mutable_counters()->mutable_rejected())["too_short"] = static_cast<std::uint64_t>(next);
  const std::string text = metrics_text(heartbeat, {});
  for (int value = 1001; value <= next; ++value) {
    EXPECT_THAT(text, HasSubstr(" " + std::to_string(value) + "\n"));
  }
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_estimation_fixes_total counter\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_estimation_frames_in_flight gauge\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_tracker_tracks gauge\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_person_tracker_tracks gauge\n"));
  EXPECT_THAT(text,
              HasSubstr("rayloc_source_rejected_total{access_point=\"ap \\\"1\\\"\\n\","
                        "reason=\"too_short\"} " +
                        std::to_string(next) + "\n"));
}

TEST(Metrics, HoldWhatIsAdded) {
  const std::string text = metrics_text(
      {}, {{"rayloc_extra_total", "An extra one", true, {{"kind", "a", 3.0}, {"kind", "b", 4.0}}}});
  EXPECT_THAT(text, HasSubstr("# HELP rayloc_extra_total An extra one\n"));
  EXPECT_THAT(text, HasSubstr("rayloc_extra_total{kind=\"a\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("rayloc_extra_total{kind=\"b\"} 4\n"));
}

}  // namespace
}  // namespace rayloc
