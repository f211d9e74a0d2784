// A second raylocd where one runs: it names the port or the path that it cannot have and ends; the
// first one goes on.
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/notify_socket.h"

namespace rayloc::e2e::second_daemon_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};

// Where a daemon is reached.
struct Places {
  std::string source;   // "udp HOST:PORT" or "unix PATH"
  std::string publish;  // endpoints
  std::string snapshot;
  std::string http;  // HOST:PORT
};

std::string free_address(int type) { return "127.0.0.1:" + std::to_string(free_port(type)); }

Places free_places() {
  return {"udp " + free_address(SOCK_DGRAM),
          "tcp://" + free_address(SOCK_STREAM),
          "tcp://" + free_address(SOCK_STREAM),
          free_address(SOCK_STREAM)};
}

std::uint16_t port_of(const std::string& address) {
  return static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
}

// NAME.toml in `folder`.
std::string configuration(const std::filesystem::path& folder,
                          const std::string& name,
                          const Places& places) {
  std::filesystem::path file = folder / (name + ".toml");
  const std::string kind = places.source.substr(0, places.source.find(' '));
  std::ofstream(file) << "[site]\ndirectory = \"" << bundled("").string()
                      << "\"\n[[source]]\naccess_point = \"ap2\"\nkind = \"" << kind << "\"\n"
                      << (kind == "udp" ? "listen" : "path") << " = \""
                      << places.source.substr(kind.size() + 1) << "\"\n[publish]\nendpoint = \""
                      << places.publish << "\"\nsnapshot = \"" << places.snapshot
                      << "\"\n[http]\nlisten = \"" << places.http << "\"\n";
  return file.string();
}

// Each place of `taken` alone, among places that are free.
void expect_each_to_be_refused(const std::filesystem::path& folder, const Places& taken) {
  for (const auto place : {&Places::source, &Places::publish, &Places::snapshot, &Places::http}) {
    Places places = free_places();
    places.*place = taken.*place;
    Process second(
        folder, "second", "raylocd", {"--config", configuration(folder, "second", places)});
    EXPECT_EQ(second.wait(kPatience), 69) << taken.*place << "\n" << second.errors();
    EXPECT_THAT(second.errors(), HasSubstr(taken.*place));
    EXPECT_THAT(second.errors(), HasSubstr("Address already in use"));
    EXPECT_THAT(second.errors(), Not(HasSubstr("preparing the room"))) << "it ends at once";
  }
}

ino_t inode_of(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
  return status.st_ino;
}

// A late subscriber receives the snapshot, and all that is published after it.
void expect_to_be_received(const std::filesystem::path& folder, const Places& places) {
  Process late(folder,
               "late",
               "rayloc",
               {"sub",
                "v1/heartbeat/",
                "--endpoint",
                places.publish,
                "--snapshot",
                places.snapshot,
                "--json",
                "--count",
                "3"});
  EXPECT_EQ(late.wait(kPatience), 0) << late.errors();
  EXPECT_EQ(late.errors(), "late.err:\n") << "it says what it lost";
}

class SecondDaemon : public ::testing::Test {
 protected:
  void start(const Places& places) {
    first_ = std::make_unique<Process>(
        folder_.path(),
        "first",
        "raylocd",
        std::vector<std::string>{"--config", configuration(folder_.path(), "first", places)},
        ProcessSetting{.environment = {manager_.variable()}});
    ASSERT_TRUE(manager_.wait_for("READY=1", kPatience)) << first_->errors();
  }
  void expect_to_end_well() {
    first_->signal(SIGTERM);
    EXPECT_EQ(first_->wait(kPatience), 0) << first_->errors();
  }

  const TemporaryFolder folder_;
  NotifySocket manager_{folder_.path()};
  std::unique_ptr<Process> first_;
};

TEST_F(SecondDaemon, OnAUsedPortIsRefusedAndTheFirstContinues) {
  const Places places = free_places();
  ASSERT_NO_FATAL_FAILURE(start(places));
  expect_each_to_be_refused(folder_.path(), places);
  expect_to_be_received(folder_.path(), places);
  Process sender(folder_.path(),
                 "send",
                 "rayloc",
                 {"send",
                  bundled_recording("calibration", "ap2"),
                  "--to",
                  places.source.substr(4),
                  "--rate",
                  "2000",
                  "--duration",
                  "1"});
  EXPECT_EQ(sender.wait(kPatience), 0) << sender.errors();
  // The last datagrams may still be in the socket.
  EXPECT_TRUE(eventually(kPatience, [&] {
    return testing::http_body(testing::http_get(port_of(places.http), "/metrics"))
               .find("\nrayloc_source_received_total{access_point=\"ap2\"} 2000\n") !=
           std::string::npos;
  })) << first_->errors();
  expect_to_end_well();
}

TEST(Field, ASecondDaemonOnATakenPortEndsBeforeItPreparesTheRoom) {
  const TemporaryFolder folder;
  LiveDaemon first(folder.path(), {.site = bundled(""), .access_points = {"ap2"}});
  ASSERT_TRUE(first.ready()) << first.errors();
  Process second(folder.path(), "second", "raylocd", {"--config", first.configuration().string()});
  EXPECT_EQ(second.wait(kPatience), 69) << second.errors();
  EXPECT_THAT(second.errors(), HasSubstr("Address already in use"));
  EXPECT_THAT(second.errors(), Not(HasSubstr("preparing the room")));
  EXPECT_EQ(first.stop(), 0) << first.errors();
}

// A path can be bound again once it is removed, and who does that takes it away unseen.
TEST_F(SecondDaemon, OnAUsedPathIsRefusedAndTheFirstKeepsIt) {
  const auto path = [this](const char* name) { return (folder_.path() / name).string(); };
  Places places = free_places();
  places.source = "unix " + path("csi");
  places.publish = "ipc://" + path("publish");
  places.snapshot = "ipc://" + path("snapshot");
  ASSERT_NO_FATAL_FAILURE(start(places));
  const std::vector<std::string> paths = {path("csi"), path("publish"), path("snapshot")};
  std::vector<ino_t> before;
  before.reserve(paths.size());
  for (const std::string& one : paths) {
    before.push_back(inode_of(one));
  }
  expect_each_to_be_refused(folder_.path(), places);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    EXPECT_EQ(inode_of(paths[i]), before[i]) << paths[i];
  }
  expect_to_be_received(folder_.path(), places);
  expect_to_end_well();
}

}  // namespace
}  // namespace rayloc::e2e::second_daemon_test
