// raylocd within the limits of its unit: names that it may not resolve, interfaces that it does not
// see, a receive buffer that the kernel cuts. Also: the filters that the tests set are those of the
// unit.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/notify_socket.h"
#include "tests/e2e/unit_filters.h"

namespace rayloc::e2e::sandbox_test {
namespace {

using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};
const char* const kUnit = "raylocd.service";

// A configuration without engine and HTTP, and the messages of raylocd with it.
class Configured {
 public:
  Configured(const std::string& source, const std::string& publish, ProcessSetting setting)
      : manager_(folder_.path()) {
    const std::filesystem::path file = folder_.path() / "raylocd.toml";
    std::ofstream(file) << "[site]\ndirectory = \"" << bundled("").string()
                        << "\"\n[[source]]\naccess_point = \"ap2\"\nkind = \"udp\"\n"
                        << source << "[engine]\nmethod = \"none\"\n[http]\nenabled = false\n"
                        << "[publish]\nsnapshot = \"ipc://" << (folder_.path() / "s").string()
                        << "\"\n"
                        << publish;
    setting.environment.push_back(manager_.variable());
    daemon_ = std::make_unique<Process>(folder_.path(),
                                        "raylocd",
                                        "raylocd",
                                        std::vector<std::string>{"--config", file.string()},
                                        setting);
  }
  Process& daemon() { return *daemon_; }
  bool ready() { return manager_.wait_for("READY=1", kPatience); }

 private:
  TemporaryFolder folder_;
  NotifySocket manager_;
  std::unique_ptr<Process> daemon_;
};

std::string listen_anywhere() {
  return "listen = \"127.0.0.1:" + std::to_string(free_port(SOCK_DGRAM)) + "\"\n";
}

std::string publish_at(const std::string& host) {
  return "endpoint = \"tcp://" + host + ":" + std::to_string(free_port(SOCK_STREAM)) + "\"\n";
}

// libzmq asks for the interfaces of the machine by AF_NETLINK, and aborts where that is denied.
TEST(Sandbox, LocalhostIsBoundUnderTheFiltersOfTheUnit) {
  if (!has_filters()) {
    GTEST_SKIP() << "this build has no filters of system calls";
  }
  const TemporaryFolder folder;
  Configured there(listen_anywhere(),
                   publish_at("localhost"),
                   {.wrapper = filters(folder.path(), allowed_calls(kUnit), "1,2,10")});
  ASSERT_TRUE(there.ready()) << there.daemon().errors();
  there.daemon().signal(SIGTERM);
  EXPECT_EQ(there.daemon().wait(kPatience), 0) << there.daemon().errors();
}

TEST(Sandbox, OtherNamesAreErrorsOfTheConfiguration) {
  for (const char* const more : {"", "insecure = true\n"}) {
    Configured there(listen_anywhere(), publish_at("lo") + more, {});
    EXPECT_EQ(there.daemon().wait(kPatience), 78) << there.daemon().errors();
    EXPECT_THAT(there.daemon().errors(), HasSubstr("raylocd.toml:13:12: 'endpoint' is 'tcp://lo:"));
    EXPECT_THAT(there.daemon().errors(), HasSubstr("write the numeric address"));
  }
}

// With PrivateNetwork= there are no interfaces to find the name among; systemd has them.
TEST(Sandbox, APassedSocketHasItsInterfaceFromItsUnit) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  Configured there(
      "only_interface = \"br0\"\n", publish_at("127.0.0.1"), {.sockets = {{"source-ap2", fd}}});
  EXPECT_EQ(there.daemon().wait(kPatience), 78) << there.daemon().errors();
  EXPECT_THAT(there.daemon().errors(),
              HasSubstr("raylocd.toml:3:1: 'only_interface' does not go with a socket"));
  EXPECT_THAT(there.daemon().errors(),
              HasSubstr("write BindToDevice=br0 in [Socket] of that unit"));
  close(fd);
}

TEST(Sandbox, ASmallReceiveBufferIsReported) {
  std::uint64_t limit = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> limit;
  constexpr std::uint64_t kWanted = 8U << 20U;
  if (limit == 0 || limit >= kWanted) {
    GTEST_SKIP() << "this machine grants it";
  }
  // Without CAP_NET_ADMIN, as in the unit.
  if (std::system("setpriv --bounding-set -net_admin true 2>/dev/null") != 0) {
    GTEST_SKIP() << "no right to give up a capability here";
  }
  Configured there(listen_anywhere(),
                   publish_at("127.0.0.1"),
                   {.wrapper = {"setpriv", "--bounding-set", "-net_admin"}});
  ASSERT_TRUE(there.ready()) << there.daemon().errors();
  EXPECT_TRUE(eventually(kPatience, [&] {
    return there.daemon().errors().find("a receive buffer of " + std::to_string(limit) +
                                        " bytes instead of 8388608") != std::string::npos;
  })) << there.daemon().errors();
  EXPECT_THAT(there.daemon().errors(), HasSubstr("sysctl -w net.core.rmem_max=8388608"));
}

// True if a shell can run `command` under the filters of the unit.
bool works_there(const std::filesystem::path& folder, const std::string& command) {
  std::string line;
  for (const std::string& word : filters(folder, allowed_calls(kUnit), "1,2,10")) {
    line += "'" + word + "' ";
  }
  return std::system((line + command + " >/dev/null 2>&1").c_str()) == 0;
}

TEST(Sandbox, TheTestFiltersRefuseTheSameCallsAsTheUnit) {
  if (!has_filters()) {
    GTEST_SKIP() << "this build has no filters of system calls";
  }
  const TemporaryFolder folder;
  ASSERT_TRUE(works_there(folder.path(), "true"));
  for (const char* const line :
       {"RestrictNamespaces=yes\n", "RestrictRealtime=yes\n", "LockPersonality=yes\n"}) {
    EXPECT_THAT(unit_text(kUnit), HasSubstr(line));
  }
  for (const std::string command :
       {"unshare --user true", "unshare --net true", "chrt --fifo 1 true", "setarch -R true"}) {
    if (std::system((command + " >/dev/null 2>&1").c_str()) == 0) {
      EXPECT_FALSE(works_there(folder.path(), command)) << command;
    }
  }
}

}  // namespace
}  // namespace rayloc::e2e::sandbox_test
