#include "daemon/pipeline/ordered_sink.h"

#include <gtest/gtest.h>

#include "daemon/publish/proto_time.h"

namespace rayloc {
namespace {

Timestamp at(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }

v1::Location location_of(int ms, const std::string& mac) {
  v1::Location location;
  *location.mutable_time() = to_proto(at(ms));
  location.mutable_target()->set_mac(mac);
  return location;
}

TEST(OrderedSink, WritesByTimeThenTarget) {
  std::string written;
  OrderedSink sink([&](const v1::Location& location) {
    written += std::to_string(location.time().nanos() / 1'000'000) + location.target().mac() + " ";
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

}  // namespace
}  // namespace rayloc
