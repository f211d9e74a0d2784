// The messages of raylocd in systemd's journal: text, and figures in separate fields.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/notify_socket.h"

namespace rayloc::e2e::journal_test {
namespace {

using ::testing::IsSupersetOf;

constexpr std::chrono::seconds kPatience{60};

void send_garbage(const std::string& address, int count) {
  const std::size_t colon = address.rfind(':');
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1))));
  inet_pton(AF_INET, address.substr(0, colon).c_str(), &to.sin_addr);
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  for (int i = 0; i < count; ++i) {
    sendto(fd, "garbage", 7, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  close(fd);
}

TEST(Journal, HasTheFiguresOfALossAsFields) {
  if (std::system("unshare --mount true 2>/dev/null") != 0) {
    GTEST_SKIP() << "a mount namespace of our own takes root";
  }
  const TemporaryFolder folder;
  // The journal's native protocol is of lines NAME=value, as sd_notify's.
  NotifySocket journal(folder.path());
  const std::string mount =
      "mount -t tmpfs none /run && mkdir -p /run/systemd/journal && ln -s " +
      (folder.path() / "notify").string() +
      R"( /run/systemd/journal/socket && export JOURNAL_STREAM=$(stat -L -c %d:%i )"
      R"(/proc/self/fd/2) && exec "$0" "$@")";
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n",
                     .setting = {.wrapper = {"unshare", "--mount", "sh", "-c", mount}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  send_garbage(daemon.address(0), 1000);
  ASSERT_TRUE(journal.wait_for("RAYLOC_SOURCE=ap2", kPatience)) << daemon.errors();
  EXPECT_THAT(journal.lines(),
              IsSupersetOf({"MESSAGE=source ap2: datagrams rejected: too_short",
                            "RAYLOC_LOSS=rejected_too_short",
                            "SYSLOG_IDENTIFIER=raylocd",
                            "PRIORITY=4"}));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// A unit's script that starts raylocd with another standard error reads the log there.
TEST(Journal, IsNotWrittenToWhenStandardErrorIsAnotherFile) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n",
                     .setting = {.environment = {"JOURNAL_STREAM=1:1"}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  EXPECT_THAT(daemon.log(), ::testing::HasSubstr("running: publishing at"));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e::journal_test
