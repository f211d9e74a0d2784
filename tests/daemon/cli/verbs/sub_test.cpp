// `rayloc sub` as a process of its own, against a real publisher.
#include <csignal>

#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/live/publish/publisher.h"
#include "rayloc/v1/envelope.pb.h"
#include "rayloc/v1/heartbeat.pb.h"
#include "tests/support/eventually.h"
#include "tests/support/rayloc_process.h"

namespace rayloc::sub_test {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kNow{1718000000s};
constexpr auto kPatience = 60s;

Publisher publisher_on_loopback() {
  PublisherOptions options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.site = "office";
  options.epoch = 7;
  auto publisher = Publisher::bind(options);
  EXPECT_TRUE(publisher) << publisher.error().message;
  return std::move(*publisher);
}

void wait_for_subscriptions(Publisher& publisher, std::uint64_t subscriptions) {
  ASSERT_TRUE(
      eventually(kPatience, [&] { return publisher.counters().subscriptions == subscriptions; }));
}

v1::Location location_of(const std::string& mac) {
  v1::Location location;
  location.mutable_target()->set_mac(mac);
  location.mutable_position()->set_x(1.5);
  return location;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end - begin));
    begin = end == std::string::npos ? text.size() : end + 1;
  }
  return lines;
}

TEST(Sub, PrintsOneEnvelopePerLineAndStopsAtTheCount) {
  Publisher publisher = publisher_on_loopback();
  const RaylocProcess process(
      {"sub", "v1/location/", "--endpoint", publisher.endpoint(), "--json", "--count", "2"});
  wait_for_subscriptions(publisher, 1);
  publisher.publish(v1::TrackEvent(), kNow);
  publisher.publish(location_of("a"), kNow);
  publisher.publish(location_of("b"), kNow);
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const auto lines = lines_of(finished.out);
  ASSERT_EQ(lines.size(), 2U);
  const auto envelope = nlohmann::json::parse(lines[0]);
  EXPECT_EQ(envelope.at("epoch"), "7");
  EXPECT_EQ(envelope.at("sequence"), "1");
  EXPECT_EQ(envelope.at("location").at("target").at("mac"), "a");
  EXPECT_EQ(envelope.at("location").at("position").at("x"), 1.5);
}

TEST(Sub, FollowsADaemonThatIsRestarted) {
  Publisher publisher = publisher_on_loopback();
  const RaylocProcess process(
      {"sub", "v1/location/", "--endpoint", publisher.endpoint(), "--count", "3"});
  wait_for_subscriptions(publisher, 1);
  publisher.publish(location_of("a"), kNow);
  PublisherOptions options;
  options.endpoint = publisher.endpoint();
  options.site = "office";
  options.epoch = 8;
  { const Publisher ended = std::move(publisher); }
  auto restarted = Publisher::bind(options);
  eventually(kPatience, [&] {  // the port is freed by a thread of libzmq
    if (!restarted) {
      restarted = Publisher::bind(options);
    }
    return restarted.has_value();
  });
  ASSERT_TRUE(restarted) << restarted.error().message;
  wait_for_subscriptions(*restarted, 1);
  restarted->publish(location_of("a"), kNow);
  restarted->publish(location_of("a"), kNow);
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.err, "rayloc sub: the daemon was restarted\n");
  ASSERT_EQ(lines_of(finished.out).size(), 3U);
  EXPECT_EQ(lines_of(finished.out)[0],
            "06:13:20.000  location   a snapshot: 1.50, 0.00, 0.00 m, 0 frames of 0 access points");
}

TEST(Sub, ReportsTheLossesOfADaemon) {
  Publisher publisher = publisher_on_loopback();
  const RaylocProcess process(
      {"sub", "v1/heartbeat/", "--endpoint", publisher.endpoint(), "--count", "1"});
  wait_for_subscriptions(publisher, 1);
  v1::Heartbeat heartbeat;
  for (int i = 0; i < 2; ++i) {
    v1::SourceCounters& counters = *heartbeat.add_sources()->mutable_counters();
    counters.set_received(100);
    counters.set_kernel_drops(3);
    counters.set_frames_dropped(7);
  }
  publisher.publish(heartbeat, kNow);
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(
      finished.out,
      "06:13:20.000  heartbeat  200 datagrams received, 6 dropped, 14 frames dropped, 0 fixes, "
      "1 subscriptions\n");
}

TEST(Sub, PrintsGeojsonByTheGeoreferenceOfTheHeartbeat) {
  Publisher publisher = publisher_on_loopback();
  const RaylocProcess process(
      {"sub", "--endpoint", publisher.endpoint(), "--format", "geojson", "--count", "2"});
  wait_for_subscriptions(publisher, 2);       // of locations, and of heartbeats
  publisher.publish(location_of("a"), kNow);  // held back until it is known where the site is
  v1::Heartbeat heartbeat;
  heartbeat.mutable_georeference()->set_latitude_deg(50.0);
  heartbeat.mutable_georeference()->set_longitude_deg(8.0);
  publisher.publish(heartbeat, kNow);
  publisher.publish(location_of("b"), kNow);
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 0) << finished.err;
  const auto lines = lines_of(finished.out);
  ASSERT_EQ(lines.size(), 2U);
  const auto feature = nlohmann::json::parse(lines[0]);
  EXPECT_EQ(feature.at("properties").at("target"), "a");
  EXPECT_NEAR(feature.at("geometry").at("coordinates").at(0).get<double>(),
              8.0 + 1.5 / 71'696.0,  // metres of a degree of longitude there
              1e-9);
}

TEST(Sub, ReportsAMissingGeoreferenceForGeojson) {
  Publisher publisher = publisher_on_loopback();
  const RaylocProcess process({"sub", "--endpoint", publisher.endpoint(), "--format", "geojson"});
  wait_for_subscriptions(publisher, 2);
  publisher.publish(v1::Heartbeat(), kNow);
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 78);
  EXPECT_NE(finished.err.find("add [georeference]"), std::string::npos) << finished.err;
}

TEST(Sub, PrintsTheFilteredAsCsv) {
  Publisher publisher = publisher_on_loopback();
  const RaylocProcess process({"sub",
                               "--endpoint",
                               publisher.endpoint(),
                               "--format",
                               "csv",
                               "--target",
                               "b",
                               "--count",
                               "1"});
  wait_for_subscriptions(publisher, 1);
  publisher.publish(location_of("a"), kNow);
  publisher.publish(location_of("b"), kNow);
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 0);
  const auto lines = lines_of(finished.out);
  ASSERT_EQ(lines.size(), 2U) << finished.out;
  EXPECT_EQ(lines[0].substr(0, 17), "time,site,target,");
  EXPECT_EQ(lines[1], "1970-01-01T00:00:00Z,,b,,unspecified,unspecified,1.5,0.0,0.0,,,0.0,,,,,0,");
}

TEST(Sub, EndsCleanlyOnSigterm) {
  Publisher publisher = publisher_on_loopback();
  const RaylocProcess process({"sub", "--endpoint", publisher.endpoint()});
  wait_for_subscriptions(publisher, 1);
  process.signal(SIGTERM);
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.out + finished.err, "");
}

TEST(Sub, GivesUpWhenNothingComes) {
  const RaylocProcess process({"sub", "--endpoint", "ipc:///nowhere/at/all", "--timeout", "0.3"});
  const Finished finished = process.wait();
  EXPECT_EQ(finished.status, 69);
  EXPECT_EQ(finished.err,
            "rayloc: no message from ipc:///nowhere/at/all; is raylocd running there?\n");
}

TEST(Sub, AnEndpointThatCannotBeUnderstoodIsAUsageError) {
  EXPECT_EQ(RaylocProcess({"sub", "--endpoint", "localhost:5560"}).wait().status, 64);
  EXPECT_EQ(RaylocProcess({"sub", "--count", "many"}).wait().status, 64);
  EXPECT_EQ(RaylocProcess({"sub", "--format", "xml"}).wait().status, 64);
  EXPECT_EQ(RaylocProcess({"sub", "--kind", "guess"}).wait().status, 64);
  EXPECT_EQ(RaylocProcess({"sub", "--min-confidence", "1.5"}).wait().status, 64);
}

}  // namespace
}  // namespace rayloc::sub_test
