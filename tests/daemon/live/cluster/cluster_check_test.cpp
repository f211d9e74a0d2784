// Tests the checks of `rayloc cluster doctor` on servers, streams, workers, sites and capture
// nodes.
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/operate/node_check.h"
#include "daemon/live/cluster/operate/server_check.h"
#include "daemon/live/cluster/operate/stream_check.h"
#include "daemon/live/cluster/operate/worker_check.h"

namespace rayloc::cluster_check_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Kind = Finding::Kind;

constexpr Timestamp kNow{seconds(1'718'000'000)};

std::vector<Kind> kinds(const std::vector<Finding>& findings) {
  std::vector<Kind> kinds;
  kinds.reserve(findings.size());
  for (const Finding& finding : findings) {
    kinds.push_back(finding.kind);
  }
  return kinds;
}

ServerGreeting greeting(const std::string& version, const std::string& cluster) {
  ServerGreeting greeting;
  greeting.version = version;
  greeting.cluster = cluster;
  greeting.jetstream = greeting.asks_for_tls = greeting.asks_who = true;
  return greeting;
}

TEST(ServerCheck, AnOldServerIsAProblemInAClusterOnly) {
  EXPECT_THAT(kinds(check_server("nats://a", greeting("2.9.10", ""))), ElementsAre(Kind::kOk));
  for (const char* const current : {"2.14.6", "2.14.10", "2.15.0", "2.15.1-RC.1", "3.0.0"}) {
    EXPECT_THAT(kinds(check_server("nats://a", greeting(current, "c"))), ElementsAre(Kind::kOk))
        << current;
  }
  for (const char* const old : {"2.9.10", "2.11.0", "2.14.5", "1.15.7", "2.15", "dev", ""}) {
    const std::vector<Finding> findings = check_server("nats://a", greeting(old, "c"));
    ASSERT_THAT(kinds(findings), ElementsAre(Kind::kProblem)) << old;
    EXPECT_THAT(findings.front().advice, HasSubstr("2.14.6")) << old;
  }
}

TEST(ServerCheck, MissingFeaturesAndProtectionAreReported) {
  ServerGreeting open = greeting("2.14.6", "");
  open.jetstream = open.asks_for_tls = false;
  const std::vector<Finding> findings = check_server("nats://a", open);
  ASSERT_THAT(kinds(findings), ElementsAre(Kind::kProblem, Kind::kWarning));
  EXPECT_THAT(findings[0].what, HasSubstr("without JetStream"));
  EXPECT_THAT(findings[1].what, HasSubstr("not encrypted"));
  EXPECT_THAT(findings[1].what, Not(HasSubstr("credentials")));
  open.asks_who = false;
  EXPECT_THAT(check_server("nats://a", open).at(1).what,
              AllOf(HasSubstr("no credentials"), HasSubstr("not encrypted")));
  EXPECT_THAT(kinds(check_server("nats://a", make_error(ErrorKind::kUnavailable, "refused"))),
              ElementsAre(Kind::kProblem));
}

StreamReport report_of(const RequiredStream& required) {
  StreamReport report;
  report.options.name = required.name;
  report.options.republish_to = required.republish_to;
  report.options.max_messages_per_subject = required.messages_per_subject;
  report.answers_directly = true;
  return report;
}

TEST(StreamCheck, AStreamMustBeAsRaylocdMakesIt) {
  const RequiredStream required = required_claim_stream();
  StreamReport report = report_of(required);
  EXPECT_THAT(kinds(check_stream(required, {report}, false)), ElementsAre(Kind::kOk));
  EXPECT_THAT(kinds(check_stream(required, {report}, true)), ElementsAre(Kind::kWarning));
  report.options.replicas = 3;
  EXPECT_THAT(kinds(check_stream(required, {report}, true)), ElementsAre(Kind::kOk));
  report.troubles = {"n2 is offline", "n3 is behind by 12 messages"};
  EXPECT_THAT(kinds(check_stream(required, {report}, true)),
              ElementsAre(Kind::kProblem, Kind::kProblem));
  report.troubles.clear();
  report.options.max_messages_per_subject = 0;
  EXPECT_THAT(check_stream(required, {report}, true).at(0).what,
              HasSubstr("not created by raylocd"));
  EXPECT_THAT(check_stream(required_csi_stream("hall"), {report}, true).at(0).what,
              HasSubstr("CSI_hall does not exist"));
}

TEST(StreamCheck, StorageNearItsLimitIsAWarning) {
  EXPECT_TRUE(check_store({1U << 30U, 1U << 30U, -1, -1}).empty());
  const std::vector<Finding> findings = check_store({7U << 20U, 9U << 20U, 10 << 20, 10 << 20});
  ASSERT_THAT(kinds(findings), ElementsAre(Kind::kWarning));
  EXPECT_THAT(findings.front().what, HasSubstr("files use 9 of 10 MiB"));
}

TEST(NodeCheck, SilenceAndClocksAreReported) {
  NodeReport report{"node 1", "CSI_hall", {}, kNow - seconds(1)};
  report.last.set_clock_synchronised(true);
  EXPECT_THAT(kinds(check_node(report, kNow)), ElementsAre(Kind::kOk));
  const auto watermark = report.stored + milliseconds(250);
  report.last.add_parts()->set_watermark_us(
      std::chrono::duration_cast<std::chrono::microseconds>(watermark.time_since_epoch()).count());
  EXPECT_THAT(kinds(check_node(report, kNow)), ElementsAre(Kind::kOk, Kind::kProblem));
  report.last.clear_parts();
  report.last.set_clock_synchronised(false);
  EXPECT_THAT(kinds(check_node(report, kNow)), ElementsAre(Kind::kWarning));
  EXPECT_THAT(check_node(report, kNow + seconds(9)).at(0).what, HasSubstr("nothing for 10 s"));
}

// A view with workers that report now.
ClusterView view_of(const std::vector<v1::WorkerState>& workers) {
  ClusterView view;
  for (v1::WorkerState state : workers) {
    state.set_now_us(
        std::chrono::duration_cast<std::chrono::microseconds>(kNow.time_since_epoch()).count());
    view.workers[state.worker()] = {state, kNow};
  }
  return view;
}

v1::WorkerState worker(const std::string& name) {
  v1::WorkerState state;
  state.set_worker(name);
  state.set_incarnation(7);
  state.set_lease_ms(2000);
  state.add_sites("hall");
  return state;
}

TEST(WorkerCheck, LoadAndClocksAreReported) {
  v1::WorkerState state = worker("w1");
  EXPECT_THAT(kinds(check_workers(view_of({state}))), ElementsAre(Kind::kOk));
  state.set_capacity(1);
  EXPECT_THAT(check_workers(view_of({state})).at(0).what, HasSubstr("capacity"));
  state.set_leaving(true);
  EXPECT_THAT(check_workers(view_of({state})).at(0).what, HasSubstr("accepts no sites"));
  state.set_shedding(1);
  EXPECT_THAT(check_workers(view_of({state})).at(0).what, HasSubstr("windows of 1"));
  ClusterView view = view_of({state});
  view.workers.at("w1").received += milliseconds(250);
  EXPECT_THAT(check_workers(view).at(0).what, HasSubstr("0.25 s behind"));
}

TEST(WorkerCheck, SettingsMustAgree) {
  EXPECT_THAT(kinds(check_workers({})), ElementsAre(Kind::kProblem));
  v1::WorkerState other = worker("w2");
  other.set_arithmetic("AVX-512");
  EXPECT_THAT(kinds(check_workers(view_of({worker("w1"), other}))),
              ElementsAre(Kind::kOk, Kind::kOk, Kind::kWarning));
  other.set_arithmetic("");
  other.set_lease_ms(500);
  EXPECT_THAT(kinds(check_workers(view_of({worker("w1"), other}))),
              ElementsAre(Kind::kOk, Kind::kOk, Kind::kProblem));
}

TEST(WorkerCheck, ASiteNeedsTheWorkerThatClaimedIt) {
  ClusterView view = view_of({worker("w1")});
  view.sites["hall"].claim.set_worker("w1");
  view.sites["hall"].claim.set_incarnation(7);
  view.sites["lab"].claim.set_worker("w1");
  view.sites["lab"].claim.set_incarnation(6);  // before its restart
  EXPECT_THAT(kinds(check_owners(view)), ElementsAre(Kind::kOk, Kind::kProblem));
  EXPECT_EQ(view.sites_without_owner(), 1U);
}

}  // namespace
}  // namespace rayloc::cluster_check_test
