// One recording by four ways into the daemon: a UDP port, the socket of rayloc-capture, a live
// interface, the file itself. Each gives the same decoded frames and counts, and what the daemon
// recorded replays to the locations that it published.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/unit_filters.h"

namespace rayloc::e2e {
namespace {

constexpr std::chrono::seconds kPatience{60};
constexpr std::size_t kDatagrams = 120;
// Seconds instead of tens of them, and still no burst runs into the next.
const char* const kSpeed = "8";

// The first datagrams of a bundled recording, uncompressed.
std::string cut_recording(const std::filesystem::path& folder) {
  const std::filesystem::path whole = folder / "whole.pcap";
  const std::string command =
      "gzip -dc '" + bundled_recording("device_los", "ap2") + "' >'" + whole.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const std::string bytes = read_text(whole);
  std::size_t end = 24;  // of the file's header; each record has one of 16 bytes
  for (std::size_t i = 0; i < kDatagrams && end + 16 <= bytes.size(); ++i) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + end + 8, sizeof length);
    end += 16 + length;
  }
  std::filesystem::path cut = folder / "cut.pcap";
  std::ofstream(cut) << bytes.substr(0, end);
  return cut.string();
}

// Owns the port that the access point sends to, where the daemon itself does not: else the kernel
// would answer that it is closed.
class BoundPort {
 public:
  explicit BoundPort(const std::string& address) : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in bound{};
    bound.sin_family = AF_INET;
    bound.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bound.sin_port =
        htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1))));
    EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&bound), sizeof bound), 0);
  }
  ~BoundPort() { close(fd_); }
  BoundPort(const BoundPort&) = delete;
  BoundPort& operator=(const BoundPort&) = delete;

 private:
  int fd_;
};

// Of a recording, by `rayloc frames`, one a line; without their times, and in an order of their
// own: frames that wait for a time-out come out later than those that are known to be complete.
std::vector<std::string> frames_of(const std::filesystem::path& folder, const std::string& file) {
  Process frames(folder, "frames", "rayloc", {"frames", "ap2=" + file, "--json", "--values"});
  EXPECT_EQ(frames.wait(kPatience), 0) << frames.errors();
  std::vector<std::string> masked;
  for (const std::string& line : read_lines(frames.out())) {
    nlohmann::json frame = nlohmann::json::parse(line);
    frame.erase("time");
    masked.push_back(frame.dump());
  }
  std::sort(masked.begin(), masked.end());
  return masked;
}

// What `some` has and `others` has not, whatever the order.
std::vector<std::string> only_in(std::vector<std::string> some, std::vector<std::string> others) {
  std::sort(some.begin(), some.end());
  std::sort(others.begin(), others.end());
  std::vector<std::string> only;
  std::set_difference(
      some.begin(), some.end(), others.begin(), others.end(), std::back_inserter(only));
  return only;
}

// Calibrated, so that what is published has positions.
const std::filesystem::path& site() {
  static const TemporaryFolder kFolder;
  static const std::filesystem::path kSite = calibrated_site(kFolder.path());
  return kSite;
}

class Sources : public ::testing::Test {
 protected:
  void SetUp() override {
    recording_ = cut_recording(folder_.path());
    expected_ = frames_of(folder_.path(), recording_);
    ASSERT_GT(expected_.size(), kDatagrams / 8);
  }

  LiveDaemonOptions options(const std::string& source) const {
    return {.site = site(),
            .access_points = {"ap2"},
            .more_configuration =
                "[record]\ndirectory = \"" + (folder_.path() / "rec").string() + "\"\n",
            .source = source};
  }

  void send_recording(const LiveDaemon& daemon) const {
    ASSERT_EQ(send(folder_.path(), "send", daemon, {recording_, "--speed", kSpeed}), 0);
  }

  static nlohmann::json counters(const LiveDaemon& daemon) {
    return daemon.bodies("heartbeat").back().at("sources").at(0).at("counters");
  }

  // Waits for everything, ends the daemon, and compares.
  void expect_everything(LiveDaemon& daemon) {
    // All but the last burst, whose end is that of the daemon: what takes longer than the time it
    // has for stopping is not published.
    EXPECT_TRUE(eventually(kPatience, [&] {
      const nlohmann::json heartbeat = daemon.bodies("heartbeat").back();
      return number(heartbeat.at("sources").at(0).at("counters").at("received")) >= kDatagrams &&
             number(heartbeat.at("estimation").at("bursts_in_flight")) <= 1;
    })) << daemon.errors();
    ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
    const nlohmann::json last = counters(daemon);
    EXPECT_EQ(number(last.at("received")), kDatagrams) << last.dump();
    EXPECT_EQ(number(last.at("processed")), kDatagrams) << last.dump();
    EXPECT_EQ(number(last.at("kernel_drops")), 0U) << last.dump();

    const std::string recorded = the_recording();
    EXPECT_EQ(frames_of(folder_.path(), recorded), expected_);
    Process replay(
        folder_.path(), "replay", "rayloc", {"replay", site().string(), "ap2=" + recorded});
    ASSERT_EQ(replay.wait(kPatience), 0) << replay.errors();
    std::vector<std::string> published;
    std::size_t positions = 0;
    for (const nlohmann::json& location : daemon.bodies("location")) {
      published.push_back(location.dump());
      positions += location.contains("position") ? 1U : 0U;
    }
    std::vector<std::string> replayed;
    for (const std::string& line : read_lines(replay.out())) {
      replayed.push_back(nlohmann::json::parse(line).dump());
    }
    EXPECT_GT(positions, 1U) << published.size() << " locations";
    EXPECT_THAT(only_in(published, replayed), ::testing::IsEmpty());
    EXPECT_THAT(only_in(replayed, published), ::testing::IsEmpty())
        << daemon.bodies("heartbeat").back().dump();
  }

  std::string the_recording() const {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "rec")) {
      files.push_back(entry.path().string());
    }
    EXPECT_EQ(files.size(), 1U);
    return files.at(0);
  }

  const TemporaryFolder folder_;
  std::string recording_;
  std::vector<std::string> expected_;
};

TEST_F(Sources, UdpPort) {
  LiveDaemon daemon(folder_.path(), options(""));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  send_recording(daemon);
  expect_everything(daemon);
}

// Under the filters of system calls of the unit with the drop-in for live capture.
TEST_F(Sources, LiveInterface) {
  ASSERT_THAT(unit_text("drop-ins/live-capture.conf"),
              ::testing::HasSubstr("\nRestrictAddressFamilies=AF_PACKET AF_NETLINK\n"));
  LiveDaemonOptions live =
      options("kind = \"interface\"\ninterface = \"lo\"\nfilter = \"udp dst port PORT\"");
  live.setting.wrapper = filters(folder_.path(), allowed_calls("raylocd.service"), "1,2,10,17,16");
  LiveDaemon daemon(folder_.path(), live);
  const BoundPort port(daemon.address(0));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  send_recording(daemon);
  expect_everything(daemon);
}

// The helper as its unit starts it: under the unit's filters of system calls.
TEST_F(Sources, SocketOfRaylocCapture) {
  const std::string path = (folder_.path() / "lo").string();
  LiveDaemon daemon(folder_.path(), options("kind = \"unix\"\npath = \"" + path + "\""));
  const BoundPort port(daemon.address(0));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const char* const unit = "rayloc-capture@.service";
  ASSERT_THAT(unit_text(unit),
              ::testing::HasSubstr("RestrictAddressFamilies=AF_UNIX AF_PACKET AF_NETLINK\n"));
  const std::string address = daemon.address(0);
  Process helper(folder_.path(),
                 "capture",
                 "rayloc-capture",
                 {"--interface",
                  "lo",
                  "--filter",
                  "udp dst port " + address.substr(address.find(':') + 1),
                  "--to",
                  path},
                 {.wrapper = filters(folder_.path(), allowed_calls(unit), "1,17,16")});
  ASSERT_TRUE(eventually(kPatience, [&] {
    return helper.errors().find(" to " + path) != std::string::npos || !helper.running();
  }));
  ASSERT_TRUE(helper.running()) << helper.errors();
  const std::string status = read_text("/proc/" + std::to_string(helper.pid()) + "/status");
  for (const char* set : {"CapInh", "CapPrm", "CapEff", "CapAmb"}) {
    EXPECT_THAT(status, ::testing::HasSubstr(std::string(set) + ":\t0000000000000000\n"));
  }
  EXPECT_THAT(status, ::testing::HasSubstr("NoNewPrivs:\t1\n"));
  send_recording(daemon);
  expect_everything(daemon);
  helper.signal(SIGTERM);
  EXPECT_EQ(helper.wait(kPatience), 0);
  EXPECT_THAT(helper.errors(), ::testing::HasSubstr("120 captured, 120 sent"));
}

// Through a pipe, so that the subscriber is there before the first frame.
TEST_F(Sources, File) {
  const std::string pipe = (folder_.path() / "pipe.pcap").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int end = open(pipe.c_str(), O_RDWR | O_CLOEXEC);
  const std::string bytes = read_text(recording_);
  constexpr std::size_t kHeader = 24;
  ASSERT_EQ(write(end, bytes.data(), kHeader), static_cast<ssize_t>(kHeader));
  LiveDaemon daemon(folder_.path(), options("kind = \"pcap\"\nfile = \"" + pipe + "\""));
  const BoundPort port(daemon.address(0));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  for (std::size_t at = kHeader; at < bytes.size();) {
    const ssize_t written = write(end, bytes.data() + at, bytes.size() - at);
    ASSERT_GT(written, 0);
    at += static_cast<std::size_t>(written);
  }
  expect_everything(daemon);
  close(end);
}

}  // namespace
}  // namespace rayloc::e2e
