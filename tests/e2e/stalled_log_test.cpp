// A terminal, a pipe or a journal that takes nothing of the log: raylocd goes on, and counts the
// messages that it could not write.
#include <fcntl.h>
#include <sys/stat.h>

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/transport/file_descriptor.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/notify_socket.h"

namespace rayloc::e2e::stalled_log_test {
namespace {

constexpr std::chrono::seconds kPatience{60};

double log_dropped(const LiveDaemon& daemon) {
  const std::string metrics = testing::http_body(testing::http_get(daemon.http_port(), "/metrics"));
  const std::string name = "\nrayloc_log_dropped_total ";
  const std::size_t at = metrics.find(name);
  return at == std::string::npos ? -1.0 : std::stod(metrics.substr(at + name.size()));
}

TEST(StalledLog, StopsNeitherTheWatchdogNorOtherThreads) {
  const TemporaryFolder folder;
  NotifySocket manager(folder.path());
  const std::string pipe = (folder.path() / "log").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const FileDescriptor reader(
      open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));  // never reads
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n",
                     .setting = {.environment = {manager.variable(), "WATCHDOG_USEC=5000000"},
                                 .wrapper = {"sh", "-c", R"(exec "$0" "$@" 2>')" + pipe + "'"}}});
  ASSERT_TRUE(daemon.ready());
  EXPECT_EQ(log_dropped(daemon), 0.0);
  // An error for each line, in one message that is longer than a pipe holds.
  std::ofstream broken(daemon.configuration(), std::ios::app);
  broken << "[record]\n";
  for (int line = 0; line < 5000; ++line) {
    broken << "nonsense_" << line << " = 1\n";
  }
  broken.close();
  daemon.signal(SIGHUP);
  const int fed = manager.count("WATCHDOG=1");
  EXPECT_TRUE(manager.wait_for("WATCHDOG=1", kPatience, fed + 3));
  EXPECT_EQ(testing::http_body(testing::http_get(daemon.http_port(), "/healthz")), "ok\n");
  EXPECT_EQ(send_for_a_second(folder.path(), daemon), 0);
  EXPECT_EQ(daemon.stop(), 0);
  EXPECT_EQ(
      number(daemon.bodies("heartbeat").back().at("sources").at(0).at("counters").at("received")),
      2000U);
}

}  // namespace
}  // namespace rayloc::e2e::stalled_log_test
