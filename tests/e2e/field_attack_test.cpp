// Attacks and shortages against a real raylocd, in their short form: messages without an end,
// invalid text, hundreds of connections, a start with too little memory or too few
// descriptors.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <deque>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zmq.hpp>

#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/endless_message.h"
#include "tests/support/hostile_client.h"

namespace rayloc::e2e::field_attack_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};

std::string tcp_endpoint() { return "tcp://127.0.0.1:" + std::to_string(free_port(SOCK_STREAM)); }

// Nothing to locate: what is asked here is what the sockets cost.
LiveDaemonOptions receiving_only(const ProcessSetting& setting = {}) {
  return {.site = bundled(""),
          .access_points = {"ap2"},
          .more_configuration = "heartbeat_s = 0.2\n[engine]\nmethod = \"none\"\n",
          .snapshot = tcp_endpoint(),
          .setting = setting};
}

nlohmann::json status_of(const LiveDaemon& daemon) {
  return nlohmann::json::parse(
      testing::http_body(testing::http_get(daemon.http_port(), "/api/v1/status")), nullptr, false);
}

TEST(Field, RaylocdCutsOffMessagesWithoutAnEndAndKeepsItsMemory) {
  constexpr std::size_t kMaxBytes = 400'000'000;
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), receiving_only());
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const double before = daemon.resident_kib();
  std::uint64_t cut = 0;
  double most = before;
  for (const std::size_t part_bytes : {1U, 4000U}) {
    for (const auto& [endpoint, type] :
         {std::pair(daemon.endpoint(), "SUB"), std::pair(daemon.snapshot(), "DEALER")}) {
      EXPECT_LT(send_endless_message(endpoint, type, part_bytes, kMaxBytes), kMaxBytes);
      most = std::max(most, daemon.resident_kib());
      ++cut;
      EXPECT_TRUE(eventually(kPatience, [&] {
        return number(status_of(daemon).at("publisher").at("clients_cut_off")) == cut;
      })) << daemon.errors();
    }
  }
  EXPECT_LT(most, before + 256 * 1024);
  const std::size_t heartbeats = daemon.bodies("heartbeat").size();
  EXPECT_TRUE(
      eventually(kPatience, [&] { return daemon.bodies("heartbeat").size() > heartbeats; }));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_THAT(daemon.log(), HasSubstr("connections cut off"));
  EXPECT_THAT(daemon.errors(), Not(HasSubstr("lost"))) << "the one who stayed";
}

TEST(Field, RaylocdReportsInvalidRequestsOnce) {
  constexpr std::uint64_t kRequests = 2000;
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), receiving_only());
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  socket.set(zmq::sockopt::linger, 0);
  socket.connect(daemon.snapshot());
  for (std::uint64_t i = 0; i < kRequests; ++i) {  // a prefix that is not UTF-8
    socket.send(zmq::message_t(std::string("\x0a\x04\xff\xfe\xfd\xfc")), zmq::send_flags::none);
  }
  EXPECT_TRUE(eventually(kPatience, [&] {
    return number(status_of(daemon).at("snapshot_server").at("malformed")) == kRequests;
  }));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_THAT(daemon.log(), Not(HasSubstr("protobuf")));
  EXPECT_THAT(daemon.log(), HasSubstr("requests of late subscribers that are none"));
  EXPECT_LT(daemon.log().size(), 5000U);
}

// Processor time of a process, in ticks.
std::uint64_t ticks_of(pid_t pid) {
  const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
  std::istringstream words(stat.substr(stat.rfind(')') + 2));
  std::string word;
  std::uint64_t user = 0;
  std::uint64_t system = 0;
  for (int i = 0; i < 11; ++i) {
    words >> word;
  }
  words >> user >> system;
  return user + system;
}

TEST(Field, RaylocdKeepsDescriptorsFreeWhenConnectionsAreTooMany) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), receiving_only({.wrapper = {"prlimit", "--nofile=100"}}));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::deque<HostileClient> crowd;
  for (int i = 0; i < 60; ++i) {
    crowd.emplace_back(daemon.endpoint(), "");
    crowd.emplace_back(daemon.snapshot(), "");
  }
  ASSERT_TRUE(eventually(kPatience, [&] {
    return number(status_of(daemon).at("publisher").at("clients_cut_off")) >= 120 - 25;
  })) << daemon.errors();
  // No thread of it tries to accept what it cannot, again and again: such a thread takes all of a
  // processor that it gets. On a busy machine the daemon uses a smaller share, not a larger one.
  const std::uint64_t before = ticks_of(daemon.pid());
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t heartbeats = daemon.bodies("heartbeat").size();
  EXPECT_TRUE(
      eventually(kPatience, [&] { return daemon.bodies("heartbeat").size() >= heartbeats + 5; }));
  const std::uint64_t used = ticks_of(daemon.pid()) - before;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(static_cast<double>(used) / static_cast<double>(sysconf(_SC_CLK_TCK)),
            0.5 * passed.count());
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_THAT(daemon.errors(), Not(HasSubstr("lost"))) << "who was there before stays";
}

// Started under a limit: ready (then it is stopped), or ended.
struct Start {
  bool ready = false;
  std::optional<int> status;
  std::string errors;
};

Start start_under(const std::string& limit) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "raylocd.toml";
  std::ofstream(file) << "[site]\ndirectory = \"" << bundled("").string()
                      << "\"\n[[source]]\naccess_point = \"ap1\"\nkind = \"udp\"\nlisten = "
                         "\"127.0.0.1:"
                      << free_port(SOCK_DGRAM)
                      << "\"\n[http]\nlisten = \"127.0.0.1:" << free_port(SOCK_STREAM)
                      << "\"\n[publish]\nendpoint = \"" << tcp_endpoint() << "\"\nsnapshot = \""
                      << tcp_endpoint() << "\"\n[cache]\nenabled = false\n";
  Process daemon(folder.path(),
                 "raylocd",
                 "raylocd",
                 {"--config", file.string()},
                 {.wrapper = {"prlimit", limit}});
  Start start;
  const auto is_ready = [&] { return daemon.errors().find("ready: ") != std::string::npos; };
  eventually(kPatience, [&] { return is_ready() || !daemon.running(); });
  start.ready = is_ready();
  daemon.signal(SIGTERM);
  start.status = daemon.wait(kPatience);
  start.errors = daemon.errors();
  return start;
}

TEST(Field, RaylocdStartsUnderALimitOfMemoryOrNamesIt) {
  bool any_ready = false;
  bool any_named = false;
  for (const std::uint64_t mib : {250U, 300U, 350U, 425U, 450U, 500U, 600U, 900U}) {
    const Start start = start_under("--as=" + std::to_string(mib << 20U));
    if (start.ready) {
      any_ready = true;
      EXPECT_EQ(start.status, 0) << mib << " MiB\n" << start.errors;
      continue;
    }
    any_named = true;
    EXPECT_EQ(start.status, 69) << mib << " MiB\n" << start.errors;
    EXPECT_THAT(start.errors, HasSubstr("ulimit -v")) << mib << " MiB";
  }
  EXPECT_TRUE(any_ready);
  EXPECT_TRUE(any_named);
}

TEST(Field, RaylocdNamesTheLimitOfDescriptorsThatIsTooLow) {
  for (const int descriptors : {20, 30, 40}) {
    const Start start = start_under("--nofile=" + std::to_string(descriptors));
    EXPECT_FALSE(start.ready);
    EXPECT_EQ(start.status, 69) << descriptors << "\n" << start.errors;
    EXPECT_THAT(start.errors, HasSubstr("ulimit -n")) << descriptors;
  }
  const Start enough = start_under("--nofile=80");
  EXPECT_TRUE(enough.ready) << enough.errors;
  EXPECT_EQ(enough.status, 0) << enough.errors;
}

}  // namespace
}  // namespace rayloc::e2e::field_attack_test
