#include "daemon/live/http/metrics.h"

#include <google/protobuf/descriptor.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc::metrics_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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
  next = number_all(*heartbeat.mutable_estimation()->add_ranks(), next);
  heartbeat.mutable_estimation()->mutable_ranks(0)->set_rank("listed");
  next = number_all(*heartbeat.mutable_tracker(), next);
  next = number_all(*heartbeat.mutable_person_tracker(), next);
  next = number_all(*heartbeat.mutable_recorder(), next);
  next = number_all(*heartbeat.mutable_publisher(), next);
  next = number_all(*heartbeat.mutable_reloads(), next);
  next = number_all(*heartbeat.mutable_capture(), next);
  next = number_all(*heartbeat.add_compared(), next);
  heartbeat.mutable_compared(0)->set_method("spotfi");
  v1::SourceReport& source = *heartbeat.add_sources();
  source.set_access_point("ap \"1\"\n");
  next = number_all(*source.mutable_counters(), next);
  (*source.mutable_counters()->mutable_rejected())["too_short"] = static_cast<std::uint64_t>(next);
  const std::string text = metrics_text({{"", heartbeat}}, heartbeat.publisher(), {});
  for (int value = 1001; value <= next; ++value) {
    EXPECT_THAT(text, HasSubstr(" " + std::to_string(value) + "\n"));
  }
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_estimation_fixes_total counter\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_estimation_frames_in_flight gauge\n"));
  EXPECT_THAT(text, HasSubstr("rayloc_rank_bursts_explained_total{rank=\"listed\"} "));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_rank_bursts_in_flight gauge\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_tracker_tracks gauge\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_person_tracker_tracks gauge\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_cluster_kept gauge\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_cluster_sent_total counter\n"));
  EXPECT_THAT(text, HasSubstr("rayloc_compared_fixes_total{method=\"spotfi\"} "));
  EXPECT_THAT(text, HasSubstr("# TYPE rayloc_compared_bursts_in_flight gauge\n"));
  EXPECT_THAT(text,
              HasSubstr("rayloc_source_rejected_total{access_point=\"ap \\\"1\\\"\\n\","
                        "reason=\"too_short\"} " +
                        std::to_string(next) + "\n"));
}

TEST(Metrics, ReportTheStateOfReceiveChains) {
  v1::Heartbeat heartbeat;
  heartbeat.add_chains()->set_access_point("ap1");
  heartbeat.mutable_chains(0)->set_knowledge(v1::CHAIN_KNOWLEDGE_LEARNING);
  v1::ChainReport& learned = *heartbeat.add_chains();
  learned.set_access_point("ap2");
  learned.set_knowledge(v1::CHAIN_KNOWLEDGE_LEARNED);
  v1::ChainTurn& turn = *learned.add_turns();
  turn.set_core(3);
  turn.set_phase_deg(-113.5);
  turn.set_phase_sigma_deg(4.25);
  const std::string text = metrics_text({{"", heartbeat}}, {}, {});
  EXPECT_THAT(text, HasSubstr("rayloc_chains_learning{access_point=\"ap1\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("rayloc_chains_learning{access_point=\"ap2\"} 0\n"));
  EXPECT_THAT(text,
              HasSubstr("rayloc_chain_phase_degrees{access_point=\"ap2\",core=\"3\"} -113.5\n"));
  EXPECT_THAT(
      text, HasSubstr("rayloc_chain_phase_sigma_degrees{access_point=\"ap2\",core=\"3\"} 4.25\n"));
}

TEST(Metrics, ReportSharedValuesOnce) {
  v1::Heartbeat office;
  office.mutable_publisher()->set_published(1);
  office.mutable_publisher()->set_csi_dropped(2);
  v1::Heartbeat lab;
  lab.mutable_publisher()->set_csi_dropped(3);
  v1::PublisherCounters shared;
  shared.set_published(7);
  const std::string text = metrics_text({{"office", office}, {"lab", lab}}, shared, {});
  EXPECT_THAT(text, HasSubstr("\nrayloc_publisher_published_total 7\n"));
  EXPECT_THAT(text, HasSubstr("\nrayloc_publisher_csi_dropped_total{site=\"office\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("\nrayloc_publisher_csi_dropped_total{site=\"lab\"} 3\n"));
  EXPECT_THAT(text, Not(HasSubstr("rayloc_publisher_csi_dropped_total 0")));
}

TEST(Metrics, ContainAddedFamilies) {
  const std::string text = metrics_text(
      {},
      {},
      {{"rayloc_extra_total", "An extra one", true, {{"kind", "a", 3.0}, {"kind", "b", 4.0}}}});
  EXPECT_THAT(text, HasSubstr("# HELP rayloc_extra_total An extra one\n"));
  EXPECT_THAT(text, HasSubstr("rayloc_extra_total{kind=\"a\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("rayloc_extra_total{kind=\"b\"} 4\n"));
}

}  // namespace
}  // namespace rayloc::metrics_test
