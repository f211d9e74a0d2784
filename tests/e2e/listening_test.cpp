// The addresses at which a running raylocd listens, by the kernel's list of its sockets: none that
// other hosts reach, except those of the configured sources. Also with a configuration that states
// no addresses.
#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/notify_socket.h"

namespace rayloc::e2e::listening_test {
namespace {

constexpr std::chrono::seconds kPatience{60};

std::set<std::string> socket_inodes(pid_t process) {
  std::set<std::string> inodes;
  const std::string fds = "/proc/" + std::to_string(process) + "/fd";
  for (const auto& entry : std::filesystem::directory_iterator(fds)) {
    std::error_code gone;
    const std::string target = std::filesystem::read_symlink(entry.path(), gone).string();
    if (target.rfind("socket:[", 0) == 0) {
      inodes.insert(target.substr(8, target.size() - 9));
    }
  }
  return inodes;
}

// "127.0.0.1" of "0100007F"; what is no IPv4 address, as the kernel writes it.
std::string address_of(const std::string& hex) {
  const std::string mapped = "0000000000000000FFFF0000";
  const std::string four = hex.rfind(mapped, 0) == 0 ? hex.substr(mapped.size()) : hex;
  if (four.size() != 8) {
    return "[" + hex + "]";
  }
  std::string text;
  for (const std::size_t at : {6U, 4U, 2U, 0U}) {
    text += (text.empty() ? "" : ".") + std::to_string(std::stoul(four.substr(at, 2), nullptr, 16));
  }
  return text;
}

// Where the process can be reached, "tcp 127.0.0.1:5560", in the network that it lives in: streams
// that listen, every socket for datagrams, raw ones and what captures.
std::set<std::string> listening(pid_t process) {
  const std::set<std::string> inodes = socket_inodes(process);
  const std::string net = "/proc/" + std::to_string(process) + "/net/";
  std::set<std::string> found;
  for (const std::string table : {"tcp", "tcp6", "udp", "udp6", "udplite", "raw", "raw6"}) {
    for (const std::string& line : read_lines(net + table)) {
      std::istringstream words(line);
      std::array<std::string, 10> field;
      for (std::string& word : field) {
        words >> word;
      }
      const bool listens = table.rfind("tcp", 0) != 0 || field[3] == "0A";
      if (listens && inodes.count(field[9]) > 0) {
        const std::size_t colon = field[1].find(':');
        found.insert(table.substr(0, 3) + " " + address_of(field[1].substr(0, colon)) + ":" +
                     std::to_string(std::stoul(field[1].substr(colon + 1), nullptr, 16)));
      }
    }
  }
  // sk RefCnt Type Proto Iface R Rmem User Inode
  for (const std::string& line : read_lines(net + "packet")) {
    std::istringstream words(line);
    std::string inode;
    while (words >> inode) {
    }
    if (inodes.count(inode) > 0) {
      found.insert("packet");
    }
  }
  return found;
}

TEST(Listening, NothingListensBeyondLoopbackButTheSources) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), {.site = bundled(""), .access_points = {"ap2"}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const std::string endpoint = daemon.endpoint();
  EXPECT_EQ(listening(daemon.pid()),
            (std::set<std::string>{"udp " + daemon.address(0),
                                   "tcp " + endpoint.substr(endpoint.rfind('/') + 1),
                                   "tcp 127.0.0.1:" + std::to_string(daemon.http_port())}));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// In a network of its own, where the default ports are free and an interface besides loopback is
// up, at which something could listen.
TEST(Listening, NothingListensBeyondLoopbackByDefault) {
  const std::string network =
      "ip link set lo up && ip link add eth7 type veth peer name eth8 && "
      "ip addr add 10.9.8.1/24 dev eth7 && ip link set eth7 up";
  if (std::system(("unshare --net sh -c '" + network + "' 2>/dev/null").c_str()) != 0) {
    GTEST_SKIP() << "no right to make a network namespace here";
  }
  const TemporaryFolder folder;
  NotifySocket manager(folder.path());
  const std::filesystem::path config = folder.path() / "raylocd.toml";
  std::ofstream(config) << "[site]\ndirectory = \"" << bundled("").string()
                        << "\"\n[[source]]\naccess_point = \"ap2\"\nkind = \"udp\"\n";
  Process daemon(folder.path(),
                 "raylocd",
                 "raylocd",
                 {"--config", config.string()},
                 {.environment = {manager.variable()},
                  .wrapper = {"unshare", "--net", "sh", "-c", network + R"( && exec "$0" "$@")"}});
  ASSERT_TRUE(manager.wait_for("READY=1", kPatience)) << daemon.errors();
  // The access point is another machine.
  EXPECT_EQ(
      listening(daemon.pid()),
      (std::set<std::string>{
          "udp 0.0.0.0:5500", "tcp 127.0.0.1:5560", "tcp 127.0.0.1:5561", "tcp 127.0.0.1:8480"}));
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(kPatience), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e::listening_test
