// The configuration of servers in deploy/cluster, against a real server: each role has the
// permissions that it needs, and everything forbidden is refused.
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/base/secret_file.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/operate/nkey.h"
#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "tests/cluster/nats_server.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/patience.h"
#include "tests/support/test_paths.h"

namespace rayloc::cluster::security_test {
namespace {

namespace fs = std::filesystem;
using e2e::LiveDaemon;
using e2e::LiveDaemonOptions;
using e2e::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};
const std::vector<std::string> kUsers = {"hall-1", "w1", "g1", "operator"};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// A server with the files of deploy/cluster, for which keys and certificates were made.
class Secured : public ::testing::Test {
 protected:
  void SetUp() override {
    RAYLOC_NEEDS_NATS_SERVER();
    ASSERT_EQ(make_certificates(), 0);
    const fs::path deploy = test::source_path("/deploy/cluster");
    std::string permissions = e2e::read_text(deploy / "permissions.conf");
    for (const std::string& user : kUsers) {
      const std::string seed = make_nkey_seed();
      ASSERT_TRUE(write_secret(seed_of(user), seed));
      permissions = replaced(permissions, "KEY_OF_" + user + ",", *nkey_of_seed(seed) + ",");
    }
    std::string server = e2e::read_text(deploy / "nats.conf");
    server = replaced(server, "/etc/nats", folder_.path().string());
    server = replaced(server, "/var/lib/nats", (folder_.path() / "store").string());
    server = replaced(server, "include routes.conf", "");  // it is alone
    server = replaced(server, "127.0.0.1:8222", "127.0.0.1:" + std::to_string(free_tcp_port()));
    std::ofstream(folder_.path() / "permissions.conf") << permissions;
    std::ofstream(folder_.path() / "nats.conf") << server;
    server_.set_configuration(folder_.path() / "nats.conf");
    ASSERT_TRUE(server_.start());
  }

  fs::path seed_of(const std::string& user) const { return folder_.path() / (user + ".nkey"); }
  std::string url() const { return replaced(server_.url(), "nats://", "tls://"); }
  BrokerOptions options_of(const std::string& user) const {
    BrokerOptions options{{url()}, user};
    options.inbox = user;
    options.ca_file = (folder_.path() / "ca.pem").string();
    options.nkey_seed_file = seed_of(user).string();
    return options;
  }
  std::shared_ptr<Broker> connected(const std::string& user) const {
    const auto broker = *open_broker(options_of(user));
    EXPECT_TRUE(wait_for_broker(*broker, test::patient(kPatience))) << broker->refusal();
    return broker;
  }
  static void expect_refused(Broker& broker, const std::string& subject) {
    ASSERT_TRUE(broker.publish(subject, "{}"));
    EXPECT_TRUE(eventually(kPatience,
                           [&] {
                             return broker.refusal().find("Publish to \"" + subject + "\"") !=
                                    std::string::npos;
                           }))
        << subject << ": " << broker.refusal();
  }
  static void expect_no_subscription(Broker& broker, const std::string& subject) {
    const auto subscription = broker.subscribe(subject, [](const BrokerMessage&) {});
    EXPECT_TRUE(eventually(kPatience,
                           [&] {
                             return broker.refusal().find("Subscription to \"" + subject + "\"") !=
                                    std::string::npos;
                           }))
        << subject << ": " << broker.refusal();
  }

  fs::path made(const std::string& name) const {
    fs::create_directories(folder_.path() / name);
    return folder_.path() / name;
  }
  LiveDaemonOptions machine(const std::string& role, const std::string& name) const {
    LiveDaemonOptions options;
    options.sites = {
        {"hall",
         site_,
         role == "capture" ? std::vector<std::string>{"ap2"} : std::vector<std::string>{}}};
    options.more_configuration = "[cluster]\nrole = \"" + role + "\"\nname = \"" + name +
                                 "\"\nretention_s = 600\nservers = [\"" + url() +
                                 "\"]\ntls_ca = \"" + (folder_.path() / "ca.pem").string() +
                                 "\"\nnkey_seed_file = \"" + seed_of(name).string() + "\"\n";
    return options;
  }

  TemporaryFolder folder_;
  fs::path site_;
  NatsServer server_{folder_.path()};

 private:
  // An authority, and the server's certificate by it.
  int make_certificates() const {
    const std::string script =
        "cd '" + folder_.path().string() +
        "' && exec 2>openssl.log &&"
        " openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2"
        " -subj /CN=ca -keyout ca.key -out ca.pem &&"
        " openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2"
        " -subj /CN=other -keyout other.key -out other.pem &&"
        " openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=n1"
        " -keyout server.key -out server.csr &&"
        " printf 'subjectAltName=IP:127.0.0.1' >server.ext &&"
        " openssl x509 -req -in server.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 2"
        " -extfile server.ext -out server.pem";
    return std::system(script.c_str());  // NOLINT(concurrency-mt-unsafe): one thread
  }
};

TEST_F(Secured, EachForbiddenThingIsRefused) {
  const auto worker = connected("w1");
  StreamOptions stream;
  ASSERT_TRUE(worker->ensure_stream(claim_stream(stream)));
  ASSERT_TRUE(worker->ensure_stream(output_stream(stream)));
  ASSERT_TRUE(worker->ensure_stream(site_stream("hall", stream)));
  ASSERT_TRUE(worker->ensure_stream(site_stream("office", stream)));
  const auto result = worker->publish_behind(claim_subject("hall"), "mine", 0);
  ASSERT_TRUE(result && result->is_last);
  const auto received = worker->last_of(std::string(kClaimStream), claim_subject("hall"));
  ASSERT_TRUE(received && *received);
  EXPECT_EQ((*received)->data, "mine");
  for (const std::string subject : {"rayloc.v1.worker.w2",
                                    "rayloc.v1.csi.hall.hall-1",
                                    "rayloc.v1.drain.w2",
                                    "$JS.API.STREAM.DELETE.CSI_hall",
                                    "$JS.API.STREAM.PURGE.OUT",
                                    "$JS.API.STREAM.UPDATE.OUT",
                                    "$JS.API.STREAM.MSG.DELETE.CLAIMS"}) {
    expect_refused(*worker, subject);
  }
  expect_no_subscription(*worker, "_INBOX.operator.>");

  const auto node = connected("hall-1");
  std::atomic<bool> stored{false};
  const auto publisher = node->acked_publisher(
      [&](std::uint64_t, const std::string& trouble) { stored = trouble.empty(); });
  ASSERT_TRUE(publisher);
  ASSERT_TRUE((*publisher)->publish(csi_subject("hall", "hall-1"), "batch", "id", 1));
  EXPECT_TRUE(eventually(kPatience, [&] { return stored.load(); })) << node->refusal();
  for (const std::string subject : {"rayloc.v1.csi.office.hall-1",
                                    "rayloc.v1.csi.hall.hall-2",
                                    "rayloc.v1.csi.hall._owner",
                                    "rayloc.v1.out.hall",
                                    "rayloc.v1.claim.hall",
                                    "$JS.API.STREAM.CREATE.CSI_hall",
                                    "$JS.API.STREAM.DELETE.CSI_hall",
                                    "$JS.API.DIRECT.GET.CSI_office"}) {
    expect_refused(*node, subject);
  }
  expect_no_subscription(*node, "rayloc.v1.live.office.>");
  expect_no_subscription(*node, "rayloc.v1.outlive.office");

  const auto gateway = connected("g1");
  EXPECT_TRUE(gateway->stream_state(std::string(kOutputStream)));
  for (const std::string subject : {"rayloc.v1.out.hall",
                                    "rayloc.v1.csi.hall.hall-1",
                                    "rayloc.v1.claim.hall",
                                    "$JS.API.STREAM.CREATE.X",
                                    "$JS.API.STREAM.DELETE.OUT"}) {
    expect_refused(*gateway, subject);
  }
  expect_no_subscription(*gateway, "rayloc.v1.live.hall.>");
}

TEST_F(Secured, RefusesClientsWithoutAKeyOrOfAnotherAuthority) {
  BrokerOptions anonymous = options_of("w1");
  anonymous.nkey_seed_file.clear();
  const auto unnamed = *open_broker(anonymous);
  EXPECT_TRUE(eventually(kPatience, [&] { return !unnamed->refusal().empty(); }));
  BrokerOptions stranger = options_of("w1");
  const fs::path seed = folder_.path() / "stranger.nkey";
  ASSERT_TRUE(write_secret(seed, make_nkey_seed()));
  stranger.nkey_seed_file = seed.string();
  const auto unknown = *open_broker(stranger);
  BrokerOptions other = options_of("w1");
  other.ca_file = (folder_.path() / "other.pem").string();
  const auto deceived = *open_broker(other);
  (void)connected("w1");
  EXPECT_FALSE(wait_for_broker(*unknown, std::chrono::milliseconds(500)));
  EXPECT_FALSE(unnamed->connected());
  EXPECT_FALSE(deceived->connected());
  other.ca_file = (folder_.path() / "none.pem").string();
  const auto refused = open_broker(other);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("tls_ca"));
  std::ofstream(folder_.path() / "bad.nkey") << "SUA\n";
  fs::permissions(folder_.path() / "bad.nkey", fs::perms::owner_read);
  other.nkey_seed_file = (folder_.path() / "bad.nkey").string();
  EXPECT_THAT(open_broker(other).error().message, HasSubstr("rayloc keygen --nkey"));
}

TEST_F(Secured, EachRoleHasItsRequiredPermissions) {
  site_ = e2e::calibrated_site(folder_.path());
  const auto operators = connected("operator");
  LiveDaemon worker(made("worker"), machine("worker", "w1"));
  ASSERT_TRUE(eventually(kPatience, [&] {
    return operators->stream_state(csi_stream("hall")).has_value();
  })) << worker.log();
  LiveDaemon gateway(made("gateway"), machine("gateway", "g1"));
  LiveDaemon node(made("node"), machine("capture", "hall-1"));
  ASSERT_TRUE(node.ready()) << node.errors() << node.log();
  e2e::Process sender(folder_.path(),
                      "send",
                      "rayloc",
                      {"send",
                       e2e::bundled_recording("calibration", "ap2"),
                       "--to",
                       node.address(0),
                       "--rate",
                       "200",
                       "--duration",
                       "600"});
  const auto run_as = [&](const std::string& user, std::vector<std::string> words) {
    words.insert(
        words.end(),
        {"--tls-ca", options_of(user).ca_file, "--nkey", seed_of(user).string(), "--inbox", user});
    e2e::Process process(folder_.path(), fs::path(words[1]).filename(), "rayloc", words);
    const int status = process.wait(kPatience).value_or(-1);
    return std::to_string(status) + "\n" + e2e::read_text(process.out()) + process.errors();
  };
  const auto ask = [&](const std::string& user, std::vector<std::string> words) {
    words.insert(words.begin(), "cluster");
    words.insert(words.end(), {"--server", url()});
    return run_as(user, std::move(words));
  };
  std::string sites;
  EXPECT_TRUE(eventually(kPatience,
                         [&] {
                           sites = ask("operator", {"sites"});
                           return sites.find("hall: worker w1, generation ") != std::string::npos &&
                                  sites.find(", results complete up to") != std::string::npos;
                         }))
      << sites << worker.log();
  const std::string doctor = ask("operator", {"doctor"});
  EXPECT_THAT(doctor, HasSubstr("ok       server " + url() + ": nats-server "));
  EXPECT_THAT(doctor, HasSubstr("ok       stream CSI_hall: 1 replicas in memory"));
  EXPECT_THAT(doctor, HasSubstr("ok       worker w1: 1 sites"));
  EXPECT_THAT(doctor, HasSubstr("ok       site hall: worker w1"));
  EXPECT_THAT(doctor, HasSubstr("capture node hall-1 of CSI_hall"));
  EXPECT_EQ(doctor.front(), '0') << doctor;
  EXPECT_THAT(ask("operator", {"apply", e2e::bundled("").string(), "--name", "attic"}),
              HasSubstr("0\nsite attic: "));
  EXPECT_THAT(ask("operator", {"apply", e2e::bundled("").string(), "--name", "cellar"}),
              HasSubstr("0\nsite cellar: "));
  EXPECT_THAT(ask("operator", {"remove", "cellar"}), HasSubstr("0\nsite cellar is taken out"));
  for (const std::string user : {"w1", "g1"}) {
    EXPECT_THAT(ask(user, {"fetch", (folder_.path() / user).string()}),
                HasSubstr("site 'attic' is there"));
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return !gateway.bodies("location").empty(); }));
  EXPECT_EQ(worker.stop(), 0) << worker.errors();
  EXPECT_EQ(gateway.stop(), 0) << gateway.errors();
  EXPECT_EQ(node.stop(), 0) << node.errors();
  const std::vector<std::string> again = {
      "replay", site_.string(), "--stream", url(), "--stream-site", "hall"};
  const std::string replayed = run_as("operator", again);
  EXPECT_EQ(replayed.front(), '0') << replayed;
  EXPECT_THAT(replayed, HasSubstr("LOCATION_KIND_"));
  EXPECT_THAT(replayed, HasSubstr(" results of 1 owners, 0 other than published"));
  for (const std::string& line : e2e::read_lines(folder_.path() / "nats" / "log")) {
    EXPECT_THAT(line, Not(HasSubstr("Violation")));
  }
  const std::string after = ask("operator", {"doctor"});
  EXPECT_EQ(after.substr(0, 2), "69") << after;
  EXPECT_THAT(after, HasSubstr("problem  no worker reports; start a raylocd with role worker"));
  EXPECT_THAT(after, HasSubstr("problem  site hall has no worker"));
}

// The package raylocd-cluster is not installed, or was not built.
TEST(WithoutTheModule, ARoleIsRefusedWithAMessage) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "bin");
  const fs::path program = folder.path() / "bin" / "rayloc";
  fs::copy_file(test::program_path("rayloc"), program);
  const std::string errors_file = (folder.path() / "errors").string();
  const std::string command = program.string() + " cluster status 2>" + errors_file;
  EXPECT_NE(std::system(command.c_str()), 0);  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_THAT(e2e::read_text(errors_file), HasSubstr("install the package raylocd-cluster"));
}

}  // namespace
}  // namespace rayloc::cluster::security_test
