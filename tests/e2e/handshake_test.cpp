// Connections that never become any, at each of the daemon's sockets, while others listen to it:
// they are counted, and cost those nothing.
#include <deque>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/hostile_client.h"

namespace rayloc::e2e::handshake_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};

nlohmann::json status_of(const LiveDaemon& daemon) {
  return nlohmann::json::parse(
      testing::http_body(testing::http_get(daemon.http_port(), "/api/v1/status")), nullptr, false);
}

void attack(const LiveDaemon& daemon) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::string http = "tcp://127.0.0.1:" + std::to_string(daemon.http_port());
  std::deque<HostileClient> open;  // some stay, saying nothing more
  for (int i = 0; i < 600; ++i) {
    switch (i % 3) {
      case 0:
        open.emplace_back(daemon.endpoint(), hostile_handshake(random));
        break;
      case 1:
        open.emplace_back(daemon.snapshot(), hostile_handshake(random));
        break;
      default:
        open.emplace_back(http, hostile_request(random));
        break;
    }
    if (open.size() > 50) {
      open.pop_front();
    }
  }
  // Some of them are still open.
  EXPECT_EQ(testing::http_body(testing::http_get(daemon.http_port(), "/healthz")), "ok\n");
}

// `more`: arguments of a subscriber that is let in.
void expect_to_go_on(LiveDaemon& daemon,
                     const std::filesystem::path& folder,
                     const std::vector<std::string>& more) {
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  attack(daemon);
  ASSERT_EQ(send_for_a_second(folder, daemon), 0);
  EXPECT_TRUE(eventually(kPatience, [&] {
    return number(status_of(daemon).at("sources").at(0).at("counters").at("received")) == 2000U;
  })) << daemon.errors();
  EXPECT_TRUE(eventually(kPatience, [&] {
    return number(status_of(daemon).at("publisher").at("handshakes_failed")) > 0;
  })) << "counted";
  std::vector<std::string> join = {"sub",
                                   "v1/",
                                   "--endpoint",
                                   daemon.endpoint(),
                                   "--snapshot",
                                   daemon.snapshot(),
                                   "--count",
                                   "1"};
  join.insert(join.end(), more.begin(), more.end());
  Process late(folder, "late", "rayloc", join);
  EXPECT_EQ(late.wait(kPatience), 0) << late.errors();
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_FALSE(daemon.bodies("location").empty());
  EXPECT_THAT(daemon.errors(), Not(HasSubstr("lost"))) << "the one who was there before";
}

TEST(Handshakes, InvalidOnesLoseNoMessage) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), {.site = bundled(""), .access_points = {"ap2"}});
  expect_to_go_on(daemon, folder.path(), {});
}

TEST(Handshakes, InvalidOnesLoseNoMessageWithCurve) {
  const TemporaryFolder folder;
  for (const std::string name : {"curve.secret", "client"}) {
    Process keygen(folder.path(), "keygen", "rayloc", {"keygen", (folder.path() / name).string()});
    ASSERT_EQ(keygen.wait(kPatience), 0) << keygen.errors();
    std::ofstream(folder.path() / (name + ".public")) << read_lines(keygen.out()).at(0) << "\n";
  }
  const std::vector<std::string> keys = {"--server-key",
                                         (folder.path() / "curve.secret.public").string(),
                                         "--key",
                                         (folder.path() / "client").string()};
  const std::string listed = read_lines(folder.path() / "client.public").at(0);
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""),
       .access_points = {"ap2"},
       .more_configuration = "[curve]\nenabled = true\nallow = [\"" + listed + "\"]\n",
       .setting = {.environment = {"CREDENTIALS_DIRECTORY=" + folder.path().string()}},
       .subscriber_arguments = keys});
  expect_to_go_on(daemon, folder.path(), keys);
}

}  // namespace
}  // namespace rayloc::e2e::handshake_test
