// Two workers as real processes, one of them a hot standby: both compute the same results, and one
// takes over at once when the other dies.
#include <csignal>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/history/story.h"
#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "daemon/live/cluster/ownership/owner_log.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/live/cluster/site_start.h"
#include "daemon/pipeline/record/system_now.h"
#include "tests/cluster/nats_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/patience.h"

namespace rayloc::cluster::standby_test {
namespace {

using e2e::LiveDaemon;
using e2e::LiveDaemonOptions;
using e2e::Process;
using e2e::TemporaryFolder;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::seconds kLease{6};  // a machine that is busy is not dead

LiveDaemonOptions options_of(const std::string& role,
                             const std::string& name,
                             const NatsServer& server,
                             bool locates) {
  LiveDaemonOptions options;
  options.sites = {
      {"hall",
       e2e::bundled(""),
       role == "capture" ? std::vector<std::string>{"ap2"} : std::vector<std::string>{}}};
  options.more_configuration =
      (locates ? "" : "[engine]\nmethod = \"none\"\n") + std::string("[cluster]\nrole = \"") +
      role + "\"\nname = \"" + name +
      "\"\nstandby = \"hot\"\nlease_s = 6\nretention_s = 7200\nservers = [\"" + server.url() +
      "\"]\n";
  return options;
}

class HotStandby : public ::testing::Test {
 protected:
  void SetUp() override {
    RAYLOC_NEEDS_NATS_SERVER();
    ASSERT_TRUE(server_.start());
    broker_ = *open_broker({{server_.url()}, "test"});
    ASSERT_TRUE(wait_for_broker(*broker_, test::patient(kPatience)));
    states_ = *broker_->subscribe(std::string(kWorkerSubjects), [this](BrokerMessage&& message) {
      v1::WorkerState state;
      if (unseal(message.data, state)) {
        const std::lock_guard lock(mutex_);
        last_states_[state.worker()] = std::move(state);
      }
    });
  }
  std::unique_ptr<LiveDaemon> begun(const std::string& role,
                                    const std::string& name,
                                    bool locates) {
    std::filesystem::create_directories(folder_.path() / name);
    return std::make_unique<LiveDaemon>(folder_.path() / name,
                                        options_of(role, name, server_, locates));
  }
  // Standby state of a worker; empty if it is no standby.
  v1::StandbyState standby(const std::string& worker) const {
    const std::lock_guard lock(mutex_);
    const auto found = last_states_.find(worker);
    return found == last_states_.end() || found->second.stands_by().empty()
               ? v1::StandbyState()
               : found->second.stands_by(0);
  }
  std::string owner() const {
    const auto message = broker_->last_of(std::string(kClaimStream), claim_subject("hall"));
    v1::SiteClaim claim;
    if (message && *message) {
      (void)unseal((*message)->data, claim);
    }
    return claim.worker();
  }
  std::string rayloc(const std::vector<std::string>& words, int expected) const {
    Process process(folder_.path(), words.front(), "rayloc", words);
    EXPECT_EQ(process.wait(kPatience).value_or(-1), expected) << process.errors();
    return e2e::read_text(process.out()) + process.errors();
  }

  TemporaryFolder folder_;
  NatsServer server_{folder_.path()};
  std::shared_ptr<Broker> broker_;
  mutable std::mutex mutex_;
  std::map<std::string, v1::WorkerState>
      last_states_;  // guarded by mutex_; the last of each worker
  std::unique_ptr<Broker::Subscription> states_;
};

TEST_F(HotStandby, ComputesTheOwnersResultsAndTakesOverAtOnce) {
  std::map<std::string, std::unique_ptr<LiveDaemon>> workers;
  for (const std::string name : {"w1", "w2"}) {
    workers[name] = begun("worker", name, true);
  }
  for (const auto& [name, one] : workers) {  // datagrams are sent only once the workers read
    ASSERT_TRUE(eventually(kPatience, [&log = *one] {
      return log.log().find("running: publishing") != std::string::npos;
    })) << one->log();
  }
  const auto node = begun("capture", "node", false);
  ASSERT_TRUE(node->ready()) << node->errors();
  Process sender(folder_.path(),
                 "send",
                 "rayloc",
                 {"send",
                  "--rate",
                  "20",
                  "--duration",
                  "600",
                  e2e::bundled_recording("device_los", "ap2"),
                  "--to",
                  node->address(0)});
  const auto next = [&] { return owner() == "w1" ? "w2" : "w1"; };
  ASSERT_TRUE(eventually(kPatience, [&] { return standby(next()).results() > 3; }))
      << workers["w1"]->log() << workers["w2"]->log();
  const std::string gone = owner();
  const std::string left = next();
  EXPECT_EQ(standby(left).differing(), 0U) << workers[left]->log();
  EXPECT_FALSE(standby(left).is_late());
  EXPECT_THAT(rayloc({"cluster", "status", "--server", server_.url()}, 0),
              HasSubstr("hot for hall: audit: "));
  workers[gone]->signal(SIGKILL);
  ASSERT_TRUE(eventually(kPatience, [&] {
    return workers[left]->log().find("goes on at once") != std::string::npos;
  })) << workers[left]->log();
  EXPECT_THAT(testing::http_body(testing::http_get(workers[left]->http_port(), "/metrics")),
              HasSubstr("rayloc_cluster_divergence_total{site=\"hall\"} 0"));
  ASSERT_TRUE(eventually(kPatience, [&] {
    const auto story = read_story(*broker_, "hall");
    return story && story->back().begin.worker() == left && story->back().items.size() > 3;
  }));
  sender.signal(SIGTERM);
  EXPECT_EQ(workers[left]->stop(), 0) << workers[left]->errors();
  const auto story = read_story(*broker_, "hall");
  ASSERT_TRUE(story);
  ASSERT_EQ(story->size(), 2U);
  EXPECT_TRUE(story->back().begin.has_stood_by());
  EXPECT_EQ(story->back().from, story->front().done);
  EXPECT_EQ(story->back().start.from, story->front().start.from);
  std::set<std::string> once;
  for (const Chapter& chapter : *story) {
    for (const v1::OutputItem& item : chapter.items) {
      EXPECT_TRUE(once.insert(item.SerializeAsString()).second) << item.ShortDebugString();
    }
  }
  // Equal, to the byte, to results of a first owner that had never died.
  EXPECT_THAT(
      rayloc(
          {"replay", e2e::bundled("").string(), "--stream", server_.url(), "--stream-site", "hall"},
          0),
      HasSubstr("results of 2 owners, 0 other than published"));
}

// The owner publishes a location that no worker can compute.
TEST_F(HotStandby, ReportsAnOwnerThatPublishesOtherResults) {
  const auto node = begun("capture", "node", false);
  ASSERT_TRUE(node->ready()) << node->errors();
  ClaimKeeper::Options claiming;
  claiming.worker = "owner";
  claiming.incarnation = 1;
  claiming.stream = claim_stream({});
  claiming.all_sites = 1;
  claiming.lease = kLease;
  const auto claims = *ClaimKeeper::open(broker_, claiming);
  claims->offer("hall");
  claims->start();
  std::uint64_t generation = 0;
  ASSERT_TRUE(eventually(kPatience, [&] {
    for (const ClaimKeeper::Change& change : claims->take_changes()) {
      generation = change.generation;
    }
    return generation > 0;
  }));
  OwnerLog::Options options;
  options.site = "hall";
  options.generation = generation;
  options.worker = "owner";
  StreamOptions stream;
  stream.in_memory = false;
  options.stream = output_stream(stream);
  const auto log = *OwnerLog::begin(broker_, options);
  const auto worker = begun("worker", "w1", false);
  v1::SiteOutput output;
  const auto append = [&] {
    output.set_done_us(us_of(system_now() - std::chrono::milliseconds(500)));
    EXPECT_EQ(log->append(output), OwnerLog::Outcome::kStored);
  };
  ASSERT_TRUE(eventually(kPatience, [&] {
    append();
    return standby("w1").windows() > 2;
  })) << worker->log();
  EXPECT_EQ(standby("w1").differing(), 0U) << worker->log();
  v1::Location& location = *output.add_items()->mutable_location();
  location.set_event_id("forged");
  location.mutable_time()->set_seconds(us_of(system_now()) / 1'000'000);
  append();
  output.clear_items();
  EXPECT_TRUE(eventually(kPatience, [&] {
    append();
    return standby("w1").differing() == 1;
  })) << worker->log();
  EXPECT_THAT(worker->log(),
              HasSubstr("its owner published other results than this worker computes"));
  EXPECT_THAT(worker->log(), HasSubstr("forged"));
  EXPECT_THAT(rayloc({"cluster", "status", "--server", server_.url()}, 0), HasSubstr(" 1 differ"));
  EXPECT_EQ(worker->stop(), 0) << worker->errors();
}

}  // namespace
}  // namespace rayloc::cluster::standby_test
