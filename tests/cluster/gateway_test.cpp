// A gateway as a real process: it publishes each result of an owner once, also after a restart.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "daemon/live/cluster/ownership/owner_log.h"
#include "daemon/live/cluster/sealed_message.h"
#include "tests/cluster/nats_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/patience.h"

namespace rayloc::cluster::gateway_test {
namespace {

using e2e::LiveDaemon;
using e2e::LiveDaemonOptions;
using e2e::TemporaryFolder;

constexpr std::chrono::seconds kPatience{60};

LiveDaemonOptions gateway(const NatsServer& server) {
  LiveDaemonOptions options;
  options.sites = {{"hall", e2e::bundled(""), {}}, {"attic", e2e::bundled(""), {}}};
  options.more_configuration =
      "[engine]\nmethod = \"none\"\n[cluster]\nrole = \"gateway\"\nname = \"g1\"\nservers = [\"" +
      server.url() + "\"]\n";
  return options;
}

std::unique_ptr<OwnerLog> begun(const std::shared_ptr<Broker>& broker,
                                const std::string& site,
                                std::uint64_t generation) {
  StreamOptions stream;
  stream.in_memory = false;
  OwnerLog::Options options;
  options.site = site;
  options.generation = generation;
  options.worker = "w";
  options.stream = output_stream(stream);
  auto log = OwnerLog::begin(broker, std::move(options));
  EXPECT_TRUE(log) << log.error().message;
  return std::move(*log);
}

std::string device_of(const std::string& site) {
  return site == "hall" ? "02:00:00:00:00:01" : "02:00:00:00:00:02";
}

// A location `second` seconds after some instant.
v1::SiteOutput output_at(const std::string& site, int second) {
  v1::SiteOutput output;
  output.set_done_us(1'700'000'000'000'000 + 1'000'000LL * (second + 1));
  v1::Location& location = *output.add_items()->mutable_location();
  location.mutable_time()->set_seconds(1'700'000'000 + second);
  location.mutable_target()->set_mac(device_of(site));
  return output;
}

std::vector<int> seconds(const LiveDaemon& daemon, const std::string& site) {
  std::vector<int> all;
  for (const nlohmann::json& location : daemon.bodies("location")) {
    if (location.at("target").at("mac") == device_of(site)) {
      const std::string time = location.at("time");
      all.push_back(std::stoi(time.substr(time.rfind(':') + 1)));
    }
  }
  return all;
}

TEST(Gateway, PublishesEachResultOfCurrentOwnersOnce) {
  RAYLOC_NEEDS_NATS_SERVER();
  const TemporaryFolder folder;
  NatsServer server(folder.path());
  ASSERT_TRUE(server.start());
  const auto broker = *open_broker({{server.url()}, "test"});
  ASSERT_TRUE(wait_for_broker(*broker, test::patient(kPatience)));
  auto first = begun(broker, "hall", 1);
  auto other = begun(broker, "attic", 4);
  // 1,700,000,000 is the 20th second of its minute.
  ASSERT_EQ(first->append(output_at("hall", 1)), OwnerLog::Outcome::kStored);
  ASSERT_EQ(other->append(output_at("attic", 2)), OwnerLog::Outcome::kStored);
  ASSERT_EQ(other->append(output_at("attic", 3)), OwnerLog::Outcome::kStored);
  {
    std::filesystem::create_directories(folder.path() / "one");
    LiveDaemon daemon(folder.path() / "one", gateway(server));
    ASSERT_TRUE(daemon.ready()) << daemon.errors() << daemon.log();
    ASSERT_TRUE(eventually(kPatience, [&] {
      return first->append(output_at("hall", 5)) == OwnerLog::Outcome::kStored &&
             !seconds(daemon, "hall").empty();
    })) << daemon.log();
    const auto second = begun(broker, "hall", 2);
    ASSERT_EQ(second->append(output_at("hall", 7)), OwnerLog::Outcome::kStored);
    // A record of a replaced owner, without a check of its predecessor.
    v1::OutputRecord stale;
    stale.set_generation(1);
    stale.set_number(99);
    *stale.mutable_output() = output_at("hall", 30);
    ASSERT_TRUE(broker->publish(output_subject("hall"), seal(stale)));
    ASSERT_TRUE(eventually(kPatience, [&] {
      return second->append(output_at("hall", 8)) == OwnerLog::Outcome::kStored;
    }));
    EXPECT_TRUE(eventually(kPatience, [&] {
      const std::vector<int> now = seconds(daemon, "hall");
      return !now.empty() && now.back() == 28;
    }));
    const std::vector<int> now = seconds(daemon, "hall");
    EXPECT_EQ(std::count(now.begin(), now.end(), 27), 1);
    EXPECT_EQ(std::count(now.begin(), now.end(), 50), 0);
    EXPECT_TRUE(eventually(kPatience, [&] {
      return testing::http_get(daemon.http_port(), "/metrics")
                 .find("rayloc_cluster_replica_faults{stream=\"OUT\"} 0") != std::string::npos;
    }));
    EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  }
  std::filesystem::create_directories(folder.path() / "two");
  LiveDaemon again(folder.path() / "two", gateway(server));
  ASSERT_TRUE(again.ready()) << again.errors();
  const auto third = begun(broker, "hall", 3);
  ASSERT_EQ(third->append(output_at("hall", 11)), OwnerLog::Outcome::kStored);
  EXPECT_TRUE(eventually(kPatience, [&] {
    const std::vector<int> now = seconds(again, "hall");
    return !now.empty() && now.back() == 31;
  }));
  // A new gateway repeats nothing: its subscribers received earlier results when they were new.
  EXPECT_EQ(seconds(again, "hall"), std::vector<int>{31});
  EXPECT_EQ(seconds(again, "attic"), std::vector<int>{});
  EXPECT_EQ(again.stop(), 0) << again.errors();
}

// A worker that owns the hall; its generation is that of its claim.
struct Owner {
  Owner(const std::shared_ptr<Broker>& broker, const std::string& worker) {
    StreamOptions stream;
    ClaimKeeper::Options options;
    options.worker = worker;
    options.incarnation = 1;
    options.lease = std::chrono::milliseconds(400);
    options.stream = claim_stream(stream);
    keeper = *ClaimKeeper::open(broker, std::move(options));
    keeper->offer("hall");
    keeper->start();
    EXPECT_TRUE(eventually(kPatience, [&] {
      for (const ClaimKeeper::Change& change : keeper->take_changes()) {
        generation = change.generation;
      }
      return generation > 0;
    }));
    log = begun(broker, "hall", generation);
  }
  std::unique_ptr<ClaimKeeper> keeper;
  std::uint64_t generation = 0;
  std::unique_ptr<OwnerLog> log;
};

TEST(Gateway, PublishesResultsAfterTheBrokerLostItsStore) {
  RAYLOC_NEEDS_NATS_SERVER();
  const TemporaryFolder folder;
  NatsServer server(folder.path());
  ASSERT_TRUE(server.start());
  const auto broker = *open_broker({{server.url()}, "test"});
  ASSERT_TRUE(wait_for_broker(*broker, test::patient(kPatience)));
  LiveDaemon daemon(folder.path(), gateway(server));
  ASSERT_TRUE(daemon.ready()) << daemon.errors() << daemon.log();
  std::uint64_t before = 0;
  {
    Owner first(broker, "w1");
    before = first.generation;
    for (int i = 0; i < 10; ++i) {
      ASSERT_EQ(first.log->append(output_at("hall", i)), OwnerLog::Outcome::kStored);
    }
    EXPECT_TRUE(eventually(kPatience, [&] { return seconds(daemon, "hall").size() == 10; }));
  }
  server.kill();
  server.lose_store();
  ASSERT_TRUE(server.start());
  ASSERT_TRUE(eventually(kPatience, [&] { return broker->connections() > 1; }));
  const Owner second(broker, "w2");  // has no record of the first owner
  EXPECT_GT(second.generation, before);
  ASSERT_EQ(second.log->append(output_at("hall", 12)), OwnerLog::Outcome::kStored);
  EXPECT_TRUE(eventually(kPatience, [&] { return seconds(daemon, "hall").size() == 11; }));
  EXPECT_EQ(seconds(daemon, "hall").back(), 32);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::cluster::gateway_test
