// A capture node as a real process, and a broker that starts late, dies and restarts.
#include <csignal>
#include <cstring>
#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "daemon/live/cluster/batch.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/cluster_names.h"
#include "tests/cluster/nats_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/numbered_sender.h"

namespace rayloc::cluster::capture_node_test {
namespace {

using e2e::LiveDaemon;
using e2e::number;
using e2e::NumberedSender;
using e2e::TemporaryFolder;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};

std::string cluster_toml(const NatsServer& server) {
  return "[engine]\nmethod = \"none\"\n[cluster]\nrole = \"capture\"\nname = \"node1\"\n"
         "storage = \"file\"\nservers = [\"" +
         server.url() + "\"]\n";
}

// The contents of a site's stream, each batch once.
struct Streamed {
  std::map<std::uint64_t, Batch> batches;
  std::map<std::string, std::set<std::uint64_t>> received;  // numbers of datagrams by access point
  std::map<std::string, std::uint64_t> marked;
};

Streamed read_stream(const std::string& url, const std::string& site) {
  const auto broker = *open_broker({{url}, "test"});
  EXPECT_TRUE(eventually(kPatience, [&] { return broker->connected(); }));
  Streamed streamed;
  const auto state = broker->stream_state(csi_stream(site));
  EXPECT_TRUE(state);
  for (std::uint64_t sequence = 1; state && sequence <= state->last; ++sequence) {
    const auto message = broker->get(csi_stream(site), sequence);
    EXPECT_TRUE(message && *message) << sequence;
    auto batch = decode_batch((*message)->data);
    EXPECT_TRUE(batch);
    streamed.batches.emplace(batch->number, std::move(*batch));
  }
  for (const auto& [number, batch] : streamed.batches) {
    for (const BatchPart& part : batch.parts) {
      for (const Datagram& datagram : part.datagrams.datagrams()) {
        std::uint64_t counted = 0;
        std::memcpy(&counted, datagram.payload.data(), sizeof counted);
        EXPECT_TRUE(streamed.received[part.access_point].insert(counted).second) << "twice";
      }
    }
    for (const BatchGap& gap : batch.gaps) {
      for (const auto& [access_point, count] : gap.datagrams) {
        streamed.marked[access_point] += count;
      }
    }
  }
  return streamed;
}

TEST(CaptureNode, EveryDatagramIsInTheStreamOrInAMarkAndAllAreRecorded) {
  RAYLOC_NEEDS_NATS_SERVER();
  const TemporaryFolder folder;
  const std::filesystem::path recordings = folder.path() / "rec";
  std::filesystem::create_directory(recordings);
  NatsServer server(folder.path());
  LiveDaemon daemon(folder.path(),
                    {.site = e2e::bundled(""),
                     .access_points = {"ap1", "ap2"},
                     .more_configuration = cluster_toml(server) + "[record]\ndirectory = \"" +
                                           recordings.string() + "\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const auto port_of = [&](std::size_t i) {
    const std::string address = daemon.address(i);
    return static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1)));
  };
  NumberedSender first(port_of(0));
  NumberedSender second(port_of(1));
  first.begin(2);
  second.begin(1);
  const auto capture = [&] {
    return nlohmann::json::parse(
               testing::http_body(testing::http_get(daemon.http_port(), "/api/v1/status")))
        .at("capture");
  };
  ASSERT_TRUE(eventually(kPatience, [&] {
    return number(capture().at("access_points").at(0).at("in_gap_marks")) > 0;
  }));
  EXPECT_THAT(daemon.log(),
              HasSubstr("cluster: no broker answers; received datagrams are still recorded"));
  ASSERT_TRUE(server.start());
  ASSERT_TRUE(eventually(kPatience, [&] {
    return capture().at("connected") == true && number(capture().at("sent")) > 50;
  }));
  server.kill();
  ASSERT_TRUE(eventually(kPatience, [&] { return capture().at("connected") == false; }));
  ASSERT_TRUE(server.start());
  const std::uint64_t before = number(capture().at("sent"));
  ASSERT_TRUE(eventually(kPatience, [&] { return number(capture().at("sent")) > before + 50; }));
  first.end();
  second.end();
  const auto all_counted = [&] {
    const nlohmann::json now = capture();
    for (const nlohmann::json& one : now.at("access_points")) {
      const std::uint64_t sent = (one.at("access_point") == "ap1" ? first : second).sent();
      if (number(one.at("captured")) != sent || number(one.at("waiting")) != 0) {
        return false;
      }
    }
    return true;
  };
  ASSERT_TRUE(eventually(kPatience, all_counted)) << capture().dump();
  const nlohmann::json last = capture();
  for (const nlohmann::json& one : last.at("access_points")) {
    EXPECT_EQ(number(one.at("captured")),
              number(one.at("in_batches")) + number(one.at("in_gap_marks")));
  }
  EXPECT_THAT(testing::http_body(testing::http_get(daemon.http_port(), "/metrics")),
              HasSubstr("rayloc_cluster_captured_total{access_point=\"ap1\"} " +
                        std::to_string(first.sent())));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();

  Streamed streamed = read_stream(server.url(), "meeting_room");
  EXPECT_EQ(streamed.received["ap1"].size() + streamed.marked["ap1"], first.sent());
  EXPECT_EQ(streamed.received["ap2"].size() + streamed.marked["ap2"], second.sent());
  EXPECT_GT(streamed.received["ap1"].size(), 0U);
  EXPECT_GT(streamed.marked["ap1"], 0U);
  const e2e::NumberedRecording recorded = e2e::read_numbered(recordings);
  EXPECT_EQ(recorded.trouble, "");
  EXPECT_EQ(recorded.numbers.size(), first.sent() + second.sent());
}

TEST(CaptureNode, ARoleWithoutServersIsRefusedWithAMessage) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = e2e::bundled(""),
                     .access_points = {"ap1"},
                     .more_configuration = "[cluster]\nrole = \"capture\"\n"});
  EXPECT_EQ(daemon.wait(kPatience), 78);
  EXPECT_THAT(daemon.log(), HasSubstr("servers = [\"nats://"));
}

}  // namespace
}  // namespace rayloc::cluster::capture_node_test
