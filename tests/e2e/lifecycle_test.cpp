// raylocd as a service manager sees it: readiness, watchdog, reload, stop, sockets that are passed.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/source/pcap_source.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/notify_socket.h"
#include "tests/e2e/unit_filters.h"

namespace rayloc::e2e::lifecycle_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};

LiveDaemonOptions one_access_point(const std::vector<std::string>& environment,
                                   const std::string& more = "") {
  return {.site = bundled(""),
          .access_points = {"ap2"},
          .more_configuration = more,
          .setting = {.environment = environment}};
}

// The process that appends to the only recording; 0 when there is none.
pid_t append_process_of(pid_t daemon) {
  const auto processes = append_processes(daemon);
  return processes.empty() ? 0 : processes.begin()->second;
}

// In the recordings whose names begin so.
std::uint64_t read_datagrams(const std::filesystem::path& folder, const std::string& prefix) {
  std::uint64_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(prefix, 0) != 0 || entry.path().extension() != ".pcap") {
      continue;
    }
    const auto source = PcapFileSource::open(entry.path().string()).value();
    DatagramBatch batch;
    while (!batch.ended && source->read(batch, Duration::zero())) {
      count += batch.datagrams.size();
    }
  }
  return count;
}

TEST(LifeCycle, ReportsReadyOnceRunningAndStoppingAtTheEnd) {
  const TemporaryFolder folder;
  NotifySocket manager(folder.path());
  LiveDaemon daemon(folder.path(), one_access_point({manager.variable()}));
  ASSERT_TRUE(manager.wait_for("READY=1", kPatience)) << daemon.errors();
  EXPECT_THAT(daemon.log(), HasSubstr("listening: ap2: udp " + daemon.address(0)));
  EXPECT_THAT(daemon.log(), HasSubstr("people are not looked for"));
  ASSERT_TRUE(eventually(kPatience, [&] {
    const std::vector<std::string>& lines = manager.lines();
    return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      return line.rfind("STATUS=0 of 1 sources receive; 0 datagrams", 0) == 0;
    });
  }));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_EQ(manager.lines().back(), "STOPPING=1");
  EXPECT_EQ(manager.count("READY=1"), 1);
  EXPECT_EQ(manager.count("WATCHDOG=1"), 0) << "nobody asked to be fed";
}

TEST(LifeCycle, ASignalEndsItWhileItIsStillStarting) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const TemporaryFolder folder;
    NotifySocket manager(folder.path());
    // A recording without a writer: opening it blocks for ever, like the tracing of a large room.
    const std::string pipe = (folder.path() / "pipe.pcap").string();
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    LiveDaemonOptions options = one_access_point({manager.variable()});
    options.source = "kind = \"pcap\"\nfile = \"" + pipe + "\"";
    LiveDaemon daemon(folder.path(), options);
    ASSERT_TRUE(eventually(kPatience, [&] {
      return daemon.log().find("preparing the room") != std::string::npos;
    })) << daemon.errors();
    daemon.signal(signal);
    EXPECT_EQ(daemon.wait(kPatience), 0) << daemon.errors();
    EXPECT_THAT(daemon.log(), HasSubstr("before the daemon was ready"));
    EXPECT_TRUE(manager.wait_for("STOPPING=1", kPatience));
    EXPECT_EQ(manager.count("READY=1"), 0);
  }
}

TEST(LifeCycle, ABlockedStageIsNamedAndStopsTheWatchdogSignal) {
  const TemporaryFolder folder;
  NotifySocket manager(folder.path());
  LiveDaemon daemon(
      folder.path(),
      one_access_point({manager.variable(), "WATCHDOG_USEC=1000000"},
                       "[record]\ndirectory = \"" + (folder.path() / "rec").string() + "\"\n"));
  ASSERT_TRUE(manager.wait_for("WATCHDOG=1", kPatience, 3)) << daemon.errors();

  // A disk that does not answer.
  const pid_t append = append_process_of(daemon.pid());
  ASSERT_NE(append, 0);
  ASSERT_EQ(kill(append, SIGSTOP), 0);
  EXPECT_EQ(send_for_a_second(folder.path(), daemon), 0);
  ASSERT_TRUE(eventually(kPatience, [&] {
    return daemon.log().find("watchdog: stage 'recorder ap2' has made no progress") !=
           std::string::npos;
  })) << daemon.errors();
  EXPECT_THAT(daemon.log(), Not(HasSubstr("stage 'source"))) << "only the guilty one";
  // The latest datagrams are saved, past the stage that is stuck.
  ASSERT_TRUE(eventually(kPatience, [&] {
    return read_datagrams(folder.path() / "rec", "ap2-snapshot-") > 0;
  })) << daemon.errors();
  // The daemon runs for several times the interval at which the watchdog would be fed.
  const int fed = manager.count("WATCHDOG=1");
  const std::size_t heartbeats = daemon.bodies("heartbeat").size();
  EXPECT_TRUE(
      eventually(kPatience, [&] { return daemon.bodies("heartbeat").size() >= heartbeats + 3; }));
  EXPECT_EQ(manager.count("WATCHDOG=1"), fed) << "fed although a stage is stuck";

  ASSERT_EQ(kill(append, SIGCONT), 0);
  EXPECT_TRUE(manager.wait_for("WATCHDOG=1", kPatience, fed + 2)) << daemon.errors();
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

TEST(LifeCycle, ASecondSignalEndsItAtOnceAndNoneWaitsForADeadDisk) {
  for (const bool twice : {true, false}) {
    const TemporaryFolder folder;
    NotifySocket manager(folder.path());
    LiveDaemon daemon(
        folder.path(),
        one_access_point({manager.variable()},
                         "[record]\ndirectory = \"" + (folder.path() / "rec").string() + "\"\n"));
    ASSERT_TRUE(daemon.ready()) << daemon.errors();
    const pid_t append = append_process_of(daemon.pid());
    ASSERT_EQ(kill(append, SIGSTOP), 0);
    EXPECT_EQ(send_for_a_second(folder.path(), daemon), 0);
    daemon.signal(SIGTERM);
    ASSERT_TRUE(manager.wait_for("STOPPING=1", kPatience)) << daemon.errors();
    if (twice) {
      // The daemon unblocks the signal just after it notifies the manager.
      eventually(kPatience, [&] {
        daemon.signal(SIGTERM);
        return !daemon.running();
      });
    }
    // The disk answers only after that: the stop has not waited for it.
    const std::optional<int> status = daemon.wait(kPatience);
    kill(append, SIGCONT);
    if (twice) {
      EXPECT_EQ(status, 128 + SIGTERM);
      EXPECT_THAT(daemon.log(), Not(HasSubstr("data that waits for the disk is lost")));
    } else {
      EXPECT_EQ(status, 70) << daemon.errors();
      EXPECT_THAT(daemon.log(), HasSubstr("data that waits for the disk is lost"));
    }
  }
}

TEST(LifeCycle, AReloadAppliesValidChangesAndRefusesABrokenFile) {
  const TemporaryFolder folder;
  NotifySocket manager(folder.path());
  LiveDaemon daemon(folder.path(), one_access_point({manager.variable()}, "heartbeat_s = 3\n"));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const std::string good = read_text(daemon.configuration());
  const auto reload = [&](const std::string& text, const std::string& message, int times) {
    std::ofstream(daemon.configuration()) << text;
    daemon.signal(SIGHUP);
    EXPECT_TRUE(manager.wait_for("RELOADING=1", kPatience, times));
    EXPECT_TRUE(manager.wait_for("READY=1", kPatience, times + 1));
    EXPECT_THAT(daemon.log(), HasSubstr(message));
  };
  reload(good + "[log]\nlevel = \"verbose\"\n[engine]\nburst_s = 0.5\n",
         "reload: nothing has changed, the configuration is wrong:\n" +
             daemon.configuration().string() + ":",
         1);
  EXPECT_THAT(daemon.log(), HasSubstr("'verbose' is no value of 'level'"));
  const std::size_t heartbeats = daemon.bodies("heartbeat").size();
  std::string faster = good;
  faster.replace(faster.find("heartbeat_s = 3"), 15, "heartbeat_s = 0.1");
  reload(faster + "[engine]\nburst_s = 0.5\n", "reload: changed publish.heartbeat_s", 2);
  EXPECT_THAT(daemon.log(), HasSubstr("refused, these need a restart: engine.burst_s"));
  EXPECT_TRUE(eventually(std::chrono::seconds(10), [&] {
    return daemon.bodies("heartbeat").size() > heartbeats + 10;
  })) << daemon.errors();
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

TEST(LifeCycle, AReloadNamesTheFilesThatOnlyARestartReads) {
  const TemporaryFolder folder;
  const std::filesystem::path site = folder.path() / "site";
  std::filesystem::copy(bundled(""), site, std::filesystem::copy_options::recursive);
  NotifySocket manager(folder.path());
  LiveDaemonOptions options = one_access_point({manager.variable()}, "");
  options.site = site;
  LiveDaemon daemon(folder.path(), options);
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  int reloads = 0;
  const auto reload = [&] {
    daemon.signal(SIGHUP);
    EXPECT_TRUE(manager.wait_for("READY=1", kPatience, ++reloads + 1));
    return daemon.log();
  };
  for (const char* const name : {"site.toml", "meshes/table.ply"}) {
    const std::string as_it_was = read_text(site / name);
    std::ofstream(site / name) << as_it_was;
    EXPECT_THAT(reload(), ::testing::Not(HasSubstr(name))) << "written again";
    std::ofstream(site / name, std::ios::app) << "\n";
    EXPECT_THAT(reload(),
                HasSubstr("refused, these need a restart: the content of " +
                          (site / name).string() + "\n"));
    std::ofstream(site / name) << as_it_was;
  }
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// A listening socket, as a .socket unit would have bound it.
int bound_socket(int type, std::uint16_t port, in_addr_t host = INADDR_LOOPBACK) {
  const int fd = socket(AF_INET, type | SOCK_CLOEXEC, 0);
  const int yes = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(host);
  EXPECT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_TRUE(type == SOCK_DGRAM || listen(fd, 16) == 0);
  return fd;
}

// A socket that systemd binds obeys the same rule as a configured address.
TEST(LifeCycle, RefusesUnguardedSocketsThatOthersCanReach) {
  for (const std::string name : {"publish", "snapshot", "http"}) {
    const TemporaryFolder folder;
    const int fd = bound_socket(SOCK_STREAM, free_port(SOCK_STREAM), INADDR_ANY);
    LiveDaemonOptions options = one_access_point({});
    options.setting.sockets = {{name, fd}};
    LiveDaemon daemon(folder.path(), options);
    EXPECT_EQ(daemon.wait(kPatience), 78) << daemon.errors();
    // The snapshot's endpoint is a path here.
    EXPECT_THAT(daemon.log(),
                HasSubstr("raylocd-" + name + ".socket " +
                          (name == "snapshot"
                               ? "passes an Internet stream socket; it must have ListenStream=/"
                               : "listens at 0.0.0.0:")));
    close(fd);
  }
  // With a token it is meant.
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "token") << "0123456789abcdef0123456789abcdef\n";
  std::filesystem::permissions(folder.path() / "token", std::filesystem::perms(0600));
  const int http = bound_socket(SOCK_STREAM, free_port(SOCK_STREAM), INADDR_ANY);
  LiveDaemonOptions options = one_access_point({});
  options.http_configuration = "token_file = \"" + (folder.path() / "token").string() + "\"\n";
  options.setting.sockets = {{"http", http}};
  LiveDaemon daemon(folder.path(), options);
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  close(http);
}

// An empty network namespace, where not even loopback is up, and the unit's filters.
std::vector<std::string> without_network(const std::filesystem::path& folder) {
  EXPECT_THAT(unit_text("drop-ins/socket-activation.conf"),
              HasSubstr("RestrictAddressFamilies=\nRestrictAddressFamilies=AF_UNIX\n"));
  std::vector<std::string> wrapper = {"unshare", "--net"};
  const std::vector<std::string> unit = filters(folder, allowed_calls("raylocd.service"), "1");
  wrapper.insert(wrapper.end(), unit.begin(), unit.end());
  return wrapper;
}

TEST(LifeCycle, TakesPassedSocketsAndNeedsNoNetworkOfItsOwn) {
  if (std::system("unshare --net true 2>/dev/null") != 0) {
    GTEST_SKIP() << "no right to make a network namespace here";
  }
  const TemporaryFolder folder;
  NotifySocket manager(folder.path());
  const std::uint16_t udp = free_port(SOCK_DGRAM);
  const int udp_socket = bound_socket(SOCK_DGRAM, udp);
  std::vector<std::pair<std::string, int>> sockets = {{"source-ap2", udp_socket}};
  const auto stream = [&](const char* name) {
    const std::uint16_t port = free_port(SOCK_STREAM);
    sockets.emplace_back(name, bound_socket(SOCK_STREAM, port));
    return port;
  };
  const std::string endpoint = "tcp://127.0.0.1:" + std::to_string(stream("publish"));
  const std::string snapshot = "tcp://127.0.0.1:" + std::to_string(stream("snapshot"));
  const std::uint16_t http = stream("http");
  const std::filesystem::path config = folder.path() / "raylocd.toml";
  std::ofstream(config) << "[site]\ndirectory = \"" << bundled("").string()
                        << "\"\n[[source]]\naccess_point = \"ap2\"\nkind = \"udp\"\n[publish]\n"
                        << "endpoint = \"" << endpoint << "\"\nsnapshot = \"" << snapshot << "\"\n";
  Process daemon(folder.path(),
                 "raylocd",
                 "raylocd",
                 {"--config", config.string()},
                 {.environment = {manager.variable()},
                  .sockets = sockets,
                  .wrapper = without_network(folder.path())});
  // Datagrams that arrive during the start wait at the access point's port, as at systemd's.
  std::for_each(sockets.begin() + 1, sockets.end(), [](const auto& s) { close(s.second); });
  ASSERT_TRUE(manager.wait_for("READY=1", kPatience)) << daemon.errors();
  EXPECT_EQ(testing::http_body(testing::http_get(http, "/healthz")), "ok\n");
  Process sender(folder.path(),
                 "send",
                 "rayloc",
                 {"send",
                  bundled_recording("calibration", "ap2"),
                  "--to",
                  "127.0.0.1:" + std::to_string(udp),
                  "--rate",
                  "1000",
                  "--duration",
                  "1"});
  std::vector<std::string> join = {"sub", "v1/source/", "--json", "--count", "3"};
  join.insert(join.end(), {"--endpoint", endpoint, "--snapshot", snapshot});
  Process subscriber(folder.path(), "sub", "rayloc", join);
  EXPECT_EQ(subscriber.wait(kPatience), 0) << subscriber.errors() << daemon.errors();
  EXPECT_EQ(sender.wait(kPatience), 0) << sender.errors();
  EXPECT_THAT(read_text(subscriber.out()), HasSubstr("SOURCE_STATUS_RECEIVING"));
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(kPatience), 0) << daemon.errors();
  close(udp_socket);
}

}  // namespace
}  // namespace rayloc::e2e::lifecycle_test
