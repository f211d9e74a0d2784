// Encrypted publishing as an operator sets it up: keys by `rayloc keygen`, [curve], and who gets
// what.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/http/http_client.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e {
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

TEST(Curve, OnlyListedClientsReadWhatIsPublished) {
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
}  // namespace rayloc::e2e
