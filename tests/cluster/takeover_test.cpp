// Two workers as real processes, one of which dies or sleeps: the other takes over, and no result
// is published twice.
#include <csignal>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"
#include "tests/cluster/nats_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::cluster::takeover_test {
namespace {

using e2e::LiveDaemon;
using e2e::LiveDaemonOptions;
using e2e::number;
using e2e::TemporaryFolder;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};
const std::vector<std::string> kSites = {"a", "b", "c"};

LiveDaemonOptions options_of(const std::string& role,
                             const std::string& name,
                             const NatsServer& server) {
  LiveDaemonOptions options;
  for (const std::string& site : kSites) {
    options.sites.push_back(
        {site,
         e2e::bundled(""),
         role == "capture" ? std::vector<std::string>{"ap2"} : std::vector<std::string>{}});
  }
  options.more_configuration = "[engine]\nmethod = \"none\"\n[cluster]\nrole = \"" + role +
                               "\"\nname = \"" + name + "\"\nservers = [\"" + server.url() +
                               "\"]\n";
  return options;
}

std::filesystem::path made(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

bool runs(LiveDaemon& daemon) {
  return eventually(kPatience, [&] {
    return daemon.log().find("running: publishing") != std::string::npos || !daemon.running();
  });
}

// A node that receives datagrams all the time, and two workers.
class TakeOver : public ::testing::Test {
 protected:
  void SetUp() override {
    RAYLOC_NEEDS_NATS_SERVER();
    ASSERT_TRUE(server_.start());
    broker_ = *open_broker({{server_.url()}, "test"});
    node_ = std::make_unique<LiveDaemon>(made(folder_.path() / "node"),
                                         options_of("capture", "node1", server_));
    for (const std::string name : {"w1", "w2"}) {
      workers_.emplace(name,
                       std::make_unique<LiveDaemon>(made(folder_.path() / name),
                                                    options_of("worker", name, server_)));
    }
    ASSERT_TRUE(node_->ready()) << node_->errors();
    for (const auto& [name, worker] : workers_) {
      ASSERT_TRUE(runs(*worker)) << worker->log();
    }
    std::vector<std::string> words = {"send", "--rate", "200", "--duration", "600"};
    for (std::size_t i = 0; i < kSites.size(); ++i) {
      words.push_back(kSites[i] + "=" + e2e::bundled_recording("calibration", "ap2"));
      words.insert(words.end(), {"--to", node_->address(i)});
    }
    sender_ = std::make_unique<e2e::Process>(folder_.path(), "send", "rayloc", words);
    ASSERT_TRUE(eventually(kPatience, [&] { return all_have_output(); })) << workers_["w1"]->log();
  }

  std::vector<v1::OutputRecord> records(const std::string& site) const {
    std::vector<v1::OutputRecord> all;
    const auto state = broker_->stream_state(std::string(kOutputStream));
    for (std::uint64_t i = 1; state && i <= state->last; ++i) {
      auto message = broker_->get(std::string(kOutputStream), i);
      EXPECT_TRUE(message || eventually(kPatience, [&] {
                    message = broker_->get(std::string(kOutputStream), i);
                    return message.has_value();
                  }));
      v1::OutputRecord record;
      if (message && *message && (*message)->subject == output_subject(site) &&
          unseal((*message)->data, record)) {
        all.push_back(record);
      }
    }
    return all;
  }
  v1::OutputRecord last_record(const std::string& site) const {
    const auto message = broker_->last_of(std::string(kOutputStream), output_subject(site));
    v1::OutputRecord record;
    if (message && *message) {
      EXPECT_TRUE(unseal((*message)->data, record));
    }
    return record;
  }
  std::string owner_of(const std::string& site) const {
    const auto message = broker_->last_of(std::string(kClaimStream), claim_subject(site));
    v1::SiteClaim claim;
    if (message && *message) {
      EXPECT_TRUE(unseal((*message)->data, claim));
    }
    return claim.worker();
  }
  bool all_have_output() const {
    return std::all_of(kSites.begin(), kSites.end(), [&](const std::string& site) {
      return last_record(site).output().done_us() > 0;
    });
  }
  // Waits until a later generation has published results of every site in `before`.
  void wait_for_others(const std::map<std::string, std::uint64_t>& before) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_TRUE(eventually(kPatience, [&] {
      return std::all_of(before.begin(), before.end(), [&](const auto& one) {
        const v1::OutputRecord last = last_record(one.first);
        return last.generation() > one.second && last.has_output();
      });
    }));
    std::cout << before.size() << " sites had results again after "
              << std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()
              << " s\n";
  }
  std::map<std::string, std::uint64_t> sites_of(const std::string& worker) const {
    std::map<std::string, std::uint64_t> sites;
    for (const std::string& site : kSites) {
      if (owner_of(site) == worker) {
        sites[site] = last_record(site).generation();
      }
    }
    return sites;
  }
  struct Outcome {
    int status = -1;
    std::string text;
    std::string errors;
  };
  // Output of `rayloc cluster` about this cluster.
  Outcome rayloc_cluster(std::vector<std::string> words) const {
    words.insert(words.begin(), "cluster");
    words.insert(words.end(), {"--server", server_.url()});
    e2e::Process process(folder_.path(), "cluster", "rayloc", words);
    const int status = process.wait(kPatience).value_or(-1);
    return {status, e2e::read_text(process.out()), process.errors()};
  }
  std::string other(const std::string& worker) const { return worker == "w1" ? "w2" : "w1"; }

  // Each generation begins where the one before it ended, with its records in order.
  void expect_one_story(const std::string& site) const {
    std::uint64_t generation = 0;
    std::uint64_t number = 0;
    std::int64_t done = 0;
    for (const v1::OutputRecord& record : records(site)) {
      if (record.has_begin()) {
        EXPECT_GT(record.generation(), generation);
        EXPECT_EQ(record.begin().done_us(), done);
        EXPECT_EQ(record.number(), 1U);
        generation = record.generation();
      } else {
        EXPECT_EQ(record.generation(), generation);
        EXPECT_EQ(record.number(), number + 1);
        EXPECT_GE(record.output().done_us(), done);
        done = record.output().done_us();
      }
      number = record.number();
    }
  }
  nlohmann::json stream_of(const std::string& worker, const std::string& site) const {
    return nlohmann::json::parse(
               testing::http_body(testing::http_get(workers_.at(worker)->http_port(),
                                                    "/site/" + site + "/api/v1/status")))
        .at("stream");
  }

  TemporaryFolder folder_;
  NatsServer server_{folder_.path()};
  std::shared_ptr<Broker> broker_;
  std::unique_ptr<LiveDaemon> node_;
  std::map<std::string, std::unique_ptr<LiveDaemon>> workers_;
  std::unique_ptr<e2e::Process> sender_;
};

TEST_F(TakeOver, FollowsAKilledWorker) {
  const std::string gone = owner_of("a");
  const auto before = sites_of(gone);
  workers_.at(gone)->signal(SIGKILL);
  wait_for_others(before);
  const std::string left = other(gone);
  for (const std::string& site : kSites) {
    EXPECT_EQ(owner_of(site), left);
    const std::int64_t done = last_record(site).output().done_us();
    EXPECT_TRUE(eventually(
        kPatience, [&] { return last_record(site).output().done_us() > done + 1'000'000; }));
    expect_one_story(site);
    EXPECT_EQ(number(stream_of(left, site).at("missing")), 0U);
    EXPECT_EQ(number(stream_of(left, site).at("lost")), 0U);
  }
  // The node does not keep consumed batches.
  EXPECT_TRUE(eventually(kPatience, [&] {
    const nlohmann::json capture =
        nlohmann::json::parse(
            testing::http_body(testing::http_get(node_->http_port(), "/site/a/api/v1/status")))
            .at("capture");
    return number(capture.at("kept")) < number(capture.at("batches")) - 50;
  }));
  EXPECT_EQ(workers_.at(left)->stop(), 0) << workers_.at(left)->errors();
  for (const std::string& site : kSites) {
    EXPECT_TRUE(last_record(site).output().released());
    EXPECT_EQ(owner_of(site), "");
  }
  const Outcome status = rayloc_cluster({"status"});
  EXPECT_EQ(status.status, 1) << status.errors;
  EXPECT_THAT(status.text, HasSubstr("0 workers, 3 sites, 3 without a worker"));
  EXPECT_THAT(rayloc_cluster({"sites"}).text, HasSubstr("a: no worker has it"));
}

TEST_F(TakeOver, RefusesASuspendedWorkerAfterItResumes) {
  const std::string asleep = owner_of("a");
  const auto before = sites_of(asleep);
  workers_.at(asleep)->signal(SIGSTOP);
  wait_for_others(before);
  workers_.at(asleep)->signal(SIGCONT);
  EXPECT_TRUE(eventually(kPatience, [&] {
    return workers_.at(asleep)->log().find("site 'a' is not owned any more") != std::string::npos;
  })) << workers_.at(asleep)->log();
  for (const auto& [site, generation] : before) {
    expect_one_story(site);
    EXPECT_EQ(owner_of(site), other(asleep));
  }
  // A record that the replaced owner would publish.
  const auto stale = broker_->publish_behind(output_subject("a"), "of yesterday", 1);
  ASSERT_TRUE(stale);
  EXPECT_FALSE(stale->is_last);
}

TEST_F(TakeOver, FollowsARequestToLeave) {
  const std::string leaving = owner_of("a");
  const auto before = sites_of(leaving);
  const Outcome status = rayloc_cluster({"status"});
  EXPECT_EQ(status.status, 0) << status.errors;
  EXPECT_THAT(
      status.text,
      HasSubstr("worker " + leaving + ": " + std::to_string(before.size()) + " sites, load "));
  EXPECT_THAT(status.text, HasSubstr("2 workers, 3 sites, 0 without a worker"));
  const Outcome sites = rayloc_cluster({"sites"});
  EXPECT_EQ(sites.status, 0) << sites.errors;
  EXPECT_THAT(sites.text, HasSubstr("a: worker " + leaving + ", generation "));
  EXPECT_THAT(sites.text, HasSubstr("results complete up to "));
  const Outcome absent = rayloc_cluster({"drain", "w3"});
  EXPECT_EQ(absent.status, 69);
  EXPECT_THAT(absent.errors, HasSubstr("worker 'w3' does not report"));
  const Outcome drained = rayloc_cluster({"drain", leaving});
  EXPECT_EQ(drained.status, 0) << drained.errors;
  EXPECT_THAT(drained.text, HasSubstr("worker " + leaving + " has given back its sites"));
  wait_for_others(before);
  EXPECT_THAT(rayloc_cluster({"status"}).text,
              HasSubstr("worker " + leaving + ": 0 sites, gives them back"));
  for (const auto& [site, generation] : before) {
    expect_one_story(site);
    EXPECT_EQ(owner_of(site), other(leaving));
  }
  EXPECT_EQ(workers_.at(leaving)->stop(), 0) << workers_.at(leaving)->errors();
}

}  // namespace
}  // namespace rayloc::cluster::takeover_test
