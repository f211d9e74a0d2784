// A capture node and a worker as real processes: the worker publishes the same frames as the node.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/live/cluster/site_start.h"
#include "daemon/pipeline/record/system_now.h"
#include "rayloc/v1/cluster.pb.h"
#include "tests/cluster/nats_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/listener.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::cluster::worker_test {
namespace {

using e2e::Listener;
using e2e::LiveDaemon;
using e2e::LiveDaemonOptions;
using e2e::number;
using e2e::TemporaryFolder;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};

LiveDaemonOptions options_of(const std::string& role, const NatsServer& server) {
  LiveDaemonOptions options;
  options.sites = {
      {"hall",
       e2e::bundled(""),
       role == "capture" ? std::vector<std::string>{"ap1", "ap2"} : std::vector<std::string>{}}};
  options.more_configuration = "csi = true\n[engine]\nmethod = \"none\"\n[cluster]\nrole = \"" +
                               role + "\"\nname = \"" + role + "1\"\nservers = [\"" + server.url() +
                               "\"]\n";
  return options;
}

std::filesystem::path made(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

void send_some(const std::filesystem::path& folder, const LiveDaemon& node) {
  EXPECT_EQ(e2e::send(folder,
                      "send",
                      node,
                      {e2e::bundled_recording("calibration", "ap1"),
                       e2e::bundled_recording("calibration", "ap2"),
                       "--rate",
                       "500",
                       "--duration",
                       "2"}),
            0);
}

nlohmann::json status_of(const LiveDaemon& daemon) {
  return nlohmann::json::parse(
      testing::http_body(testing::http_get(daemon.http_port(), "/site/hall/api/v1/status")));
}

// Sum over all sources.
std::uint64_t received(const LiveDaemon& daemon) {
  std::uint64_t all = 0;
  const nlohmann::json status = status_of(daemon);
  for (const nlohmann::json& source : status.at("sources")) {
    all += number(source.at("counters").at("received"));
  }
  return all;
}

// The results of the hall are published up to this instant.
std::int64_t done_us(Broker& broker) {
  const auto message = broker.last_of(std::string(kOutputStream), output_subject("hall"));
  v1::OutputRecord record;
  return message && *message && unseal((*message)->data, record) ? record.output().done_us() : 0;
}

TEST(Worker, PublishesTheFramesOfItsCaptureNode) {
  RAYLOC_NEEDS_NATS_SERVER();
  const TemporaryFolder folder;
  NatsServer server(folder.path());
  ASSERT_TRUE(server.start());
  const auto broker = *open_broker({{server.url()}, "test"});
  LiveDaemon node(made(folder.path() / "node"), options_of("capture", server));
  LiveDaemon worker(made(folder.path() / "worker"), options_of("worker", server));
  ASSERT_TRUE(node.ready()) << node.errors();
  ASSERT_TRUE(worker.ready()) << worker.errors() << worker.log();
  Listener of_node(node.endpoint());
  Listener of_worker(worker.endpoint());
  ASSERT_TRUE(eventually(kPatience, [&] { return of_node.received() && of_worker.received(); }));
  send_some(folder.path(), node);
  ASSERT_TRUE(eventually(kPatience,
                         [&] { return received(node) > 0 && received(worker) == received(node); }))
      << received(worker) << " of " << received(node) << "\n"
      << status_of(worker).dump() << worker.errors();
  const nlohmann::json stream = status_of(worker).at("stream");
  EXPECT_EQ(number(stream.at("missing")), 0U);
  EXPECT_EQ(number(stream.at("lost")), 0U);
  // No datagram arrives any more: `done_us` still advances, and the site does not appear late.
  const std::int64_t now = us_of(system_now());
  EXPECT_TRUE(eventually(kPatience, [&] { return done_us(*broker) > now; })) << done_us(*broker);
  EXPECT_EQ(node.stop(), 0) << node.errors();
  EXPECT_EQ(worker.stop(), 0) << worker.errors();
  ASSERT_TRUE(of_node.wait_for_goodbye(kPatience));
  ASSERT_TRUE(of_worker.wait_for_goodbye(kPatience));
  EXPECT_GT(of_node.frames().size(), 100U);
  EXPECT_EQ(of_worker.frames(), of_node.frames());
}

TEST(Worker, ReadsTheRemainingStreamAfterALateStart) {
  RAYLOC_NEEDS_NATS_SERVER();
  const TemporaryFolder folder;
  NatsServer server(folder.path());
  ASSERT_TRUE(server.start());
  LiveDaemon node(made(folder.path() / "node"), options_of("capture", server));
  ASSERT_TRUE(node.ready()) << node.errors();
  send_some(folder.path(), node);
  LiveDaemon worker(made(folder.path() / "worker"), options_of("worker", server));
  ASSERT_TRUE(worker.ready()) << worker.errors() << worker.log();
  EXPECT_TRUE(eventually(kPatience,
                         [&] { return received(node) > 0 && received(worker) == received(node); }))
      << received(worker) << " of " << received(node);
  server.freeze();
  EXPECT_TRUE(eventually(kPatience, [&] {
    return worker.log().find("cannot be read, it is opened again: no broker answers") !=
           std::string::npos;
  })) << worker.log();
  server.thaw();
  EXPECT_EQ(worker.stop(), 0) << worker.errors();
}

TEST(Worker, HasNoSourcesOfItsOwn) {
  const TemporaryFolder folder;
  NatsServer server(folder.path());
  LiveDaemonOptions options = options_of("worker", server);
  options.sites.front().access_points = {"ap1"};
  LiveDaemon worker(folder.path(), options);
  EXPECT_EQ(worker.wait(kPatience), 78);
  EXPECT_THAT(worker.log(), HasSubstr("leave [[source]] out"));
}

}  // namespace
}  // namespace rayloc::cluster::worker_test
