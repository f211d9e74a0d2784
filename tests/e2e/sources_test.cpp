// One recording by four ways into the daemon: a UDP port, the socket of rayloc-capture, a live
// interface, the file itself. Each publishes the frames that the decoder alone makes of it, to the
// byte, and counts what it counts; and what the daemon recorded replays to the very bytes of the
// locations that it published.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <memory>

#include <gmock/gmock.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/delimited_message_util.h>
#include <gtest/gtest.h>

#include "daemon/messages/topic.h"
#include "rayloc/v1/location.pb.h"
#include "tests/e2e/decoded_recording.h"
#include "tests/e2e/listener.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/stated.h"
#include "tests/e2e/unit_filters.h"

namespace rayloc::e2e::sources_test {
namespace {

constexpr std::chrono::seconds kPatience{60};
// Seconds instead of tens of them, and still no burst runs into the next.
// With sanitizers so slow that an estimator of theirs is hardly behind: it would merge bursts. Not
// below half of the pace, at which what was late would not be.
const double kSpeed = std::max(0.5, 8.0 / (slower() * slower()));

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

// The locations of `rayloc replay` for the recording of ap2: v1::Location as bytes, of each topic
// in order.
std::map<std::string, std::vector<std::string>> replayed(const std::filesystem::path& folder,
                                                         const std::filesystem::path& site,
                                                         const std::string& recording) {
  Process replay(
      folder, "replay", "rayloc", {"replay", site.string(), "ap2=" + recording, "--format", "pb"});
  EXPECT_EQ(replay.wait(kPatience), 0) << replay.errors();
  LocationBytes locations;
  const std::string bytes = read_text(replay.out());
  google::protobuf::io::ArrayInputStream stream(bytes.data(), static_cast<int>(bytes.size()));
  v1::Location location;
  bool ended = false;
  while (google::protobuf::util::ParseDelimitedFromZeroCopyStream(&location, &stream, &ended)) {
    add(make_topic("location", "meeting_room", target_component(location.target())),
        location,
        locations);
    location.Clear();
  }
  EXPECT_TRUE(ended) << "a message is cut off";
  return locations;
}

std::string text_of(const std::string& bytes) {
  v1::Location location;
  location.ParseFromString(bytes);
  return location.ShortDebugString().substr(0, 500);
}

void expect_same(const LocationBytes& published, const LocationBytes& replayed) {
  ASSERT_EQ(published.size(), replayed.size()) << "topics";
  for (const auto& [topic, messages] : published) {
    ASSERT_EQ(replayed.count(topic), 1U) << topic;
    const std::vector<std::string>& others = replayed.at(topic);
    EXPECT_EQ(messages.size(), others.size()) << topic;
    for (std::size_t i = 0; i < std::min(messages.size(), others.size()); ++i) {
      ASSERT_TRUE(messages[i] == others[i])
          << topic << " message " << i << "\npublished " << text_of(messages[i]) << "\nreplayed  "
          << text_of(others[i]);
    }
  }
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
    expected_ = decode(recording_.file);
    ASSERT_GT(expected_.frames.size(), recording_.datagrams / 8);
    ASSERT_EQ(expected_.counters.at("duplicates"), 1U);
    ASSERT_EQ(expected_.counters.at("late"), 1U);
    ASSERT_GT(expected_.counters.at("frames_partial"), 0U);
    ASSERT_EQ(expected_.counters.at("processed") + 1, recording_.datagrams) << "one is rejected";
  }

  LiveDaemonOptions options(const std::string& source) const {
    return {.site = site(),
            .access_points = {"ap2"},
            .more_configuration =
                "csi = true\n[record]\ndirectory = \"" + (folder_.path() / "rec").string() + "\"\n",
            .source = source,
            .subscriptions = {"v1/heartbeat/"}};
  }

  void send_recording(const LiveDaemon& daemon) const {
    ASSERT_EQ(send(folder_.path(),
                   "send",
                   daemon,
                   {recording_.file.string(), "--speed", std::to_string(kSpeed)}),
              0);
  }

  // Waits until the daemon is ready and a listener receives all that it publishes.
  void listen(LiveDaemon& daemon) {
    ASSERT_TRUE(daemon.ready()) << daemon.errors();
    listener_ = std::make_unique<Listener>(daemon.endpoint());
    ASSERT_TRUE(eventually(kPatience, [&] { return listener_->received(); }));
  }

  // Waits for everything, ends the daemon, and compares.
  void expect_everything(LiveDaemon& daemon) {
    // All but the last burst, whose end is that of the daemon: what takes longer than the time it
    // has for stopping is not published.
    EXPECT_TRUE(eventually(kPatience, [&] {
      const nlohmann::json heartbeat = daemon.bodies("heartbeat").back();
      return number(heartbeat.at("sources").at(0).at("counters").at("received")) >=
                 recording_.datagrams &&
             number(heartbeat.at("estimation").at("bursts_in_flight")) <= 1;
    })) << daemon.errors();
    ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
    ASSERT_TRUE(listener_->wait_for_goodbye(kPatience)) << daemon.errors();
    const nlohmann::json last = daemon.bodies("heartbeat").back();
    EXPECT_EQ(counters_of(last.at("sources").at(0).at("counters")), expected_.counters);
    EXPECT_TRUE(listener_->frames() == expected_.frames)
        << listener_->frames().size() << " frames published, " << expected_.frames.size()
        << " decoded";

    const std::string recorded = the_recording();
    const Decoded again = decode(recorded);
    EXPECT_TRUE(again.frames == expected_.frames) << again.frames.size() << " frames recorded";
    EXPECT_EQ(again.counters, expected_.counters);
    std::size_t positions = 0;
    for (const auto& [topic, messages] : listener_->locations()) {
      positions += static_cast<std::size_t>(
          std::count_if(messages.begin(), messages.end(), [](const std::string& bytes) {
            v1::Location location;
            return location.ParseFromString(bytes) && location.has_position();
          }));
    }
    EXPECT_GT(positions, 1U) << last.dump();
    expect_same(listener_->locations(), replayed(folder_.path(), site(), recorded));
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
  CutRecording recording_;
  Decoded expected_;
  std::unique_ptr<Listener> listener_;
};

TEST_F(Sources, UdpPort) {
  LiveDaemon daemon(folder_.path(), options(""));
  ASSERT_NO_FATAL_FAILURE(listen(daemon));
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
  ASSERT_NO_FATAL_FAILURE(listen(daemon));
  send_recording(daemon);
  expect_everything(daemon);
}

// The helper as its unit starts it: under the unit's filters of system calls.
TEST_F(Sources, SocketOfRaylocCapture) {
  const std::string path = (folder_.path() / "lo").string();
  LiveDaemon daemon(folder_.path(), options("kind = \"unix\"\npath = \"" + path + "\""));
  const BoundPort port(daemon.address(0));
  ASSERT_NO_FATAL_FAILURE(listen(daemon));
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
  EXPECT_THAT(helper.errors(),
              ::testing::HasSubstr(std::to_string(recording_.datagrams) + " captured, " +
                                   std::to_string(recording_.datagrams) + " sent"));
}

// Through a pipe, so that the subscriber is there before the first frame.
TEST_F(Sources, File) {
  const std::string pipe = (folder_.path() / "pipe.pcap").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int end = open(pipe.c_str(), O_RDWR | O_CLOEXEC);
  const std::string bytes = read_text(recording_.file);
  constexpr std::size_t kHeader = 24;
  ASSERT_EQ(write(end, bytes.data(), kHeader), static_cast<ssize_t>(kHeader));
  LiveDaemon daemon(folder_.path(), options("kind = \"pcap\"\nfile = \"" + pipe + "\""));
  const BoundPort port(daemon.address(0));
  ASSERT_NO_FATAL_FAILURE(listen(daemon));
  for (std::size_t at = kHeader; at < bytes.size();) {
    const ssize_t written = write(end, bytes.data() + at, bytes.size() - at);
    ASSERT_GT(written, 0);
    at += static_cast<std::size_t>(written);
  }
  expect_everything(daemon);
  close(end);
}

}  // namespace
}  // namespace rayloc::e2e::sources_test
