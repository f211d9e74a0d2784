// Encrypted publishing as an operator sets it up: keys by `rayloc keygen`, [curve], and who gets
// what.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zmq.hpp>

#include "daemon/live/publish/socket/curve_client.h"
#include "rayloc/v1/snapshot.pb.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/patience.h"

namespace rayloc::e2e::curve_test {
namespace {

using ::testing::HasSubstr;
using testing::http_body;
using testing::http_get;

constexpr std::chrono::seconds kPatience{60};

// Keys in `folder`: NAME holds the secret, NAME.public what `rayloc keygen` printed. Returns the
// public key.
std::string make_keys(const std::filesystem::path& folder, const std::string& name) {
  Process keygen(folder, "keygen", "rayloc", {"keygen", (folder / name).string()});
  EXPECT_EQ(keygen.wait(kPatience), 0) << keygen.errors();
  std::string key = read_lines(keygen.out()).at(0);
  std::ofstream(folder / (name + ".public")) << key << "\n";
  return key;
}

std::vector<std::string> keys_of(const std::filesystem::path& folder, const std::string& name) {
  return {"--server-key", (folder / "server.public").string(), "--key", (folder / name).string()};
}

TEST(Curve, OnlyListedClientsReceiveMessages) {
  const TemporaryFolder folder;
  make_keys(folder.path(), "server");
  std::filesystem::copy_file(folder.path() / "server", folder.path() / "curve.secret");
  const std::string listed = make_keys(folder.path(), "listed");
  const std::string stranger = make_keys(folder.path(), "stranger");
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""),
       .access_points = {"ap2"},
       .more_configuration = "[curve]\nenabled = true\nallow = [\"" + listed + "\"]\n",
       // As systemd's LoadCredential= would.
       .setting = {.environment = {"CREDENTIALS_DIRECTORY=" + folder.path().string()}},
       .subscriber_arguments = keys_of(folder.path(), "listed")});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);

  int runs = 0;
  const auto subscribe = [&](std::vector<std::string> more, int status) {
    more.insert(more.begin(), {"sub", "v1/", "--endpoint", daemon.endpoint(), "--count", "1"});
    Process sub(folder.path(), "sub" + std::to_string(++runs), "rayloc", more);
    EXPECT_EQ(sub.wait(kPatience), status) << sub.errors();
    EXPECT_EQ(read_text(sub.out()).empty(), status != 0);
  };
  std::vector<std::string> late = keys_of(folder.path(), "listed");
  late.insert(late.end(), {"--snapshot", daemon.snapshot()});
  subscribe(late, 0);
  subscribe({"--timeout", "1.5"}, 69);
  std::vector<std::string> unlisted = keys_of(folder.path(), "stranger");
  unlisted.insert(unlisted.end(), {"--timeout", "1.5"});
  subscribe(unlisted, 69);

  EXPECT_THAT(daemon.log(),
              HasSubstr("turned away a client whose key is not in [curve] allow "
                        "client_key=" +
                        stranger + " address=127.0.0.1"));
  EXPECT_GT(number(daemon.bodies("heartbeat").back().at("publisher").at("clients_denied")), 0U);
  const std::string metrics = http_body(http_get(daemon.http_port(), "/metrics"));
  EXPECT_THAT(metrics, HasSubstr("\nrayloc_publisher_clients_denied_total "));
  EXPECT_THAT(metrics, HasSubstr("\nrayloc_publisher_handshakes_failed_total "));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// As `keys_of`, for a client in this process.
CurveClientKeys client_keys(const std::filesystem::path& folder, const std::string& name) {
  return {read_curve_public(folder / "server.public").value(),
          read_curve_secret(folder / name).value()};
}

// Topics of the snapshot that the daemon gives to a client with these keys; nothing when it does
// not answer for so long.
std::optional<int> topics_for(const LiveDaemon& daemon,
                              const std::optional<CurveClientKeys>& keys,
                              std::chrono::milliseconds patience) {
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  socket.set(zmq::sockopt::linger, 0);
  use_curve(keys, socket);
  socket.set(zmq::sockopt::rcvtimeo, static_cast<int>(patience.count()));
  socket.connect(daemon.snapshot());
  v1::SnapshotRequest request;
  request.add_prefixes("v1/");
  socket.send(zmq::buffer(request.SerializeAsString()), zmq::send_flags::dontwait);
  zmq::message_t answer;
  if (!socket.recv(answer)) {
    return std::nullopt;
  }
  v1::SnapshotReply reply;
  EXPECT_TRUE(reply.ParseFromString(answer.to_string()));
  return reply.topics_size();
}

TEST(Curve, OnlyListedClientsGetASnapshot) {
  const TemporaryFolder folder;
  make_keys(folder.path(), "server");
  const std::string listed = make_keys(folder.path(), "listed");
  make_keys(folder.path(), "stranger");
  for (const char* const scheme : {"ipc", "tcp"}) {
    const std::string tcp = "tcp://127.0.0.1:" + std::to_string(free_port(SOCK_STREAM));
    LiveDaemonOptions options;
    options.site = bundled("");
    options.access_points = {"ap2"};
    options.snapshot = scheme == std::string("tcp") ? tcp : "";
    options.more_configuration =
        "[curve]\nenabled = true\nsecret_file = \"server\"\nallow = [\"" + listed + "\"]\n";
    options.subscriber_arguments = keys_of(folder.path(), "listed");
    LiveDaemon daemon(folder.path(), options);
    ASSERT_TRUE(daemon.ready()) << daemon.errors();
    ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);
    constexpr std::chrono::milliseconds kSilence{1500};
    EXPECT_EQ(topics_for(daemon, std::nullopt, kSilence), std::nullopt) << scheme;
    EXPECT_EQ(topics_for(daemon, client_keys(folder.path(), "stranger"), kSilence), std::nullopt)
        << scheme;
    EXPECT_GE(topics_for(daemon, client_keys(folder.path(), "listed"), test::patient(kPatience))
                  .value_or(0),
              2)
        << scheme;
    EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
    const nlohmann::json heartbeat = daemon.bodies("heartbeat").back();
    EXPECT_EQ(number(heartbeat.at("snapshot_server").at("answered")), 1U);
    EXPECT_GE(number(heartbeat.at("publisher").at("clients_denied")), 1U);
    EXPECT_GE(number(heartbeat.at("publisher").at("handshakes_failed")), 2U);
  }
}

TEST(Curve, ASecretThatEveryoneMayReadIsRefused) {
  const TemporaryFolder folder;
  const std::string key = make_keys(folder.path(), "server");
  Process again(folder.path(), "again", "rayloc", {"keygen", (folder.path() / "server").string()});
  EXPECT_EQ(again.wait(kPatience), 69) << "a key is never overwritten";
  std::filesystem::permissions(folder.path() / "server", std::filesystem::perms(0644));
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[curve]\nenabled = true\nsecret_file = \"server\"\n"
                                           "allow = [\"" +
                                           key + "\"]\n"});
  EXPECT_EQ(daemon.wait(kPatience), 78);
  EXPECT_THAT(daemon.log(), HasSubstr("everyone on this machine may use this secret key"));
}

}  // namespace
}  // namespace rayloc::e2e::curve_test
