#include "daemon/pipeline/ordered_sink.h"

#include <gtest/gtest.h>

namespace rayloc::ordered_sink_test {
namespace {

Timestamp at(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }

Location location_of(int ms, const std::string& mac) {
  Location location;
  location.estimate.time = at(ms);
  location.target.address = mac;
  return location;
}

TEST(OrderedSink, WritesByTimeThenTarget) {
  std::string written;
  OrderedSink sink([&](const Location& location) {
    const auto since = location.estimate.time.time_since_epoch();
    written += std::to_string(since / std::chrono::milliseconds(1)) + location.target.address + " ";
  });
  sink.location(location_of(20, "b"));
  sink.location(location_of(10, "c"));
  sink.location(location_of(20, "a"));
  sink.advance(at(20));
  EXPECT_EQ(written, "10c ");
  sink.location(location_of(20, "0"));
  sink.advance(at(21));
  EXPECT_EQ(written, "10c 200 20a 20b ");
  sink.location(location_of(30, "a"));
  sink.finish();
  EXPECT_EQ(written, "10c 200 20a 20b 30a ");
}

TEST(OrderedSink, WaitsForLaggingTargets) {
  std::string written;
  OrderedSink sink([&](const Location& location) { written += location.target.address; },
                   {},
                   std::chrono::milliseconds(15));
  sink.location(location_of(20, "b"));
  sink.advance(at(30));
  EXPECT_EQ(written, "");
  sink.location(location_of(16, "a"));
  sink.advance(at(36));
  EXPECT_EQ(written, "ab");
  sink.location(location_of(40, "c"));
  sink.finish();
  EXPECT_EQ(written, "abc");
}

TEST(OrderedSink, WritesASnapshotBeforeTheTrackersEstimate) {
  std::string written;
  OrderedSink sink([&](const Location& location) {
    written += location.is_filtered() ? "filtered " : "snapshot ";
  });
  Location filtered = location_of(10, "a");
  filtered.tracked = Tracked{};
  sink.location(std::move(filtered));
  sink.location(location_of(10, "a"));
  sink.finish();
  EXPECT_EQ(written, "snapshot filtered ");
}

}  // namespace
}  // namespace rayloc::ordered_sink_test
