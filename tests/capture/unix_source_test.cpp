// UnixSource and RelaySender, one at each end of a real socket.
#include "capture/source/unix_source.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/transport/relay_sender.h"

namespace rayloc::unix_source_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

// Later than every clock that the tests run by, so that the sender's times decide.
constexpr Timestamp kStart{std::chrono::sys_days(std::chrono::year(2150) / 1 / 1)};

class UnixSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (std::filesystem::temp_directory_path() / "rayloc-unix.XXXXXX").string();
    ASSERT_NE(mkdtemp(folder_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path() const { return folder_ + "/socket"; }

  std::unique_ptr<UnixSource> open() const {
    auto source = UnixSource::open({.path = path()});
    EXPECT_TRUE(source) << source.error().message;
    return std::move(*source);
  }
  std::unique_ptr<RelaySender> sender() const { return *RelaySender::open(path()); }

  // A batch of datagrams a millisecond apart, the first `after` behind kStart.
  static DatagramBatch batch_of(const std::vector<std::string>& payloads, Duration after) {
    DatagramBatch batch;
    for (const std::string& payload : payloads) {
      Datagram datagram;
      datagram.time = kStart + after + batch.datagrams.size() * 1ms;
      datagram.address.source_port = 1234;
      datagram.payload = std::as_bytes(std::span(payload));
      batch.datagrams.push_back(datagram);
    }
    batch.watermark = kStart + after;
    return batch;
  }

  // Returns the datagrams that have arrived, as text.
  static std::vector<std::string> read(UnixSource& source, DatagramBatch& batch) {
    EXPECT_TRUE(source.read(batch, 0ms));
    std::vector<std::string> payloads;
    for (const Datagram& d : batch.datagrams) {
      payloads.emplace_back(reinterpret_cast<const char*>(d.payload.data()), d.payload.size());
    }
    return payloads;
  }

  // Bytes that are not from a RelaySender.
  void send_raw(const std::string& bytes) const {
    const int fd = socket(AF_UNIX, SOCK_DGRAM, 0);
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    path().copy(&to.sun_path[0], sizeof to.sun_path - 1);
    EXPECT_EQ(
        sendto(
            fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to),
        static_cast<ssize_t>(bytes.size()));
    close(fd);
  }

  std::string folder_;
};

TEST_F(UnixSourceTest, DeliversCapturedDatagramsUnchanged) {
  const auto source = open();
  const auto relay = sender();
  EXPECT_TRUE(relay->write(batch_of({"one", "", "three"}, 0ms)));
  DatagramBatch batch;
  EXPECT_THAT(read(*source, batch), ElementsAre("one", "", "three"));
  EXPECT_EQ(batch.datagrams[2].time, kStart + 2ms);
  EXPECT_EQ(batch.datagrams[2].address.source_port, 1234);
  EXPECT_EQ(batch.watermark, kStart);
  // An idle sender goes on promising.
  EXPECT_TRUE(relay->write(batch_of({}, 50ms)));
  EXPECT_THAT(read(*source, batch), ElementsAre());
  EXPECT_EQ(batch.watermark, kStart + 50ms);
  const SourceCounters counters = source->counters();
  EXPECT_EQ(counters.received, 3U);
  EXPECT_EQ(counters.delivered, 3U);
  EXPECT_EQ(counters.bytes, 8U);
  EXPECT_EQ(counters.kernel_drops, 0U);
  EXPECT_EQ(relay->counters().delivered, 3U);
}

TEST_F(UnixSourceTest, CountsDatagramsTheSenderCouldNotDeliver) {
  auto source = open();
  const auto relay = sender();
  DatagramBatch batch;
  EXPECT_TRUE(relay->write(batch_of({"first"}, 0ms)));
  EXPECT_THAT(read(*source, batch), ElementsAre("first"));
  // Without a reader the socket's queue fills, and the rest is lost.
  const std::vector<std::string> many(5000, std::string(1000, 'x'));
  EXPECT_TRUE(relay->write(batch_of(many, 10ms)));
  EXPECT_GT(relay->counters().lost_by.at("not_taken"), 0U);
  std::size_t got = 0;
  for (std::size_t n = 1; n > 0; got += n) {
    n = read(*source, batch).size();
  }
  EXPECT_EQ(got, relay->counters().delivered - 1);
  // The tail of the loss shows with the next tick.
  EXPECT_TRUE(relay->write(batch_of({}, 9s)));
  read(*source, batch);
  EXPECT_EQ(source->counters().kernel_drops, relay->counters().lost_by.at("not_taken"));
  EXPECT_EQ(source->counters().delivered + source->counters().kernel_drops, 5001U);
}

TEST_F(UnixSourceTest, CountsLossesWhileAbsentAndRejectionsOfTheSender) {
  const auto relay = sender();
  EXPECT_TRUE(relay->write(batch_of({"nobody there"}, 0ms)));
  EXPECT_EQ(relay->counters().lost_by.at("not_there"), 1U);
  EXPECT_FALSE(relay->connected());
  const auto source = open();
  DatagramBatch batch;
  SourceCounters captured;
  captured.kernel_drops = 3;
  captured.rejected["not_udp"] = 2;
  relay->note_source(captured);
  EXPECT_TRUE(relay->write(batch_of({"heard"}, 10ms)));
  EXPECT_THAT(read(*source, batch), ElementsAre("heard"));
  // Losses before this source was opened do not count.
  EXPECT_EQ(source->counters().kernel_drops, 0U);
  captured.kernel_drops = 5;
  captured.rejected["not_udp"] = 3;
  captured.rejected["ipv6"] = 4;
  relay->note_source(captured);
  EXPECT_TRUE(relay->write(batch_of({"heard"}, 20ms)));
  read(*source, batch);
  EXPECT_EQ(source->counters().kernel_drops, 2U);
  EXPECT_THAT(source->counters().rejected, ElementsAre(Pair("rayloc_capture", 5U)));
  EXPECT_EQ(source->counters().received, 7U);
  // Another run of the sender counts from nothing, and is no gap.
  EXPECT_TRUE(sender()->write(batch_of({"again"}, 30ms)));
  EXPECT_THAT(read(*source, batch), ElementsAre("again"));
  EXPECT_EQ(source->counters().kernel_drops, 2U);
}

TEST_F(UnixSourceTest, TimeNeverGoesBack) {
  const auto source = open();
  DatagramBatch batch;
  EXPECT_TRUE(sender()->write(batch_of({"late run"}, 1h)));
  read(*source, batch);
  EXPECT_EQ(batch.watermark, kStart + 1h);
  EXPECT_TRUE(sender()->write(batch_of({"clock was set back"}, 0ms)));
  read(*source, batch);
  EXPECT_EQ(batch.datagrams[0].time, kStart + 1h);
  EXPECT_EQ(batch.watermark, kStart + 1h);
}

TEST_F(UnixSourceTest, FollowsTheClockWhereThereIsNoSender) {
  const auto source = open();
  DatagramBatch batch;
  read(*source, batch);
  const Timestamp now = std::chrono::system_clock::now();
  EXPECT_LT(batch.watermark, now);
  EXPECT_GT(batch.watermark, now - 1h);
}

TEST_F(UnixSourceTest, RejectsDatagramsThatAreNotRelayed) {
  const auto source = open();
  send_raw("RLC1 and nothing more");
  send_raw(std::string(100, 'x'));
  send_raw(std::string(6000, 'x'));
  RelayHeader header;
  header.time = Timestamp(-1s);
  const auto bytes = encode_relay_header(header);
  send_raw(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  DatagramBatch batch;
  EXPECT_THAT(read(*source, batch), ElementsAre());
  EXPECT_THAT(source->counters().rejected,
              ElementsAre(Pair("not_relayed", 3U), Pair("oversized", 1U)));
  EXPECT_EQ(source->counters().received, 4U);
}

TEST_F(UnixSourceTest, AcceptsOnlyItsOwnUserAndRoot) {
  if (geteuid() != 0) {
    GTEST_SKIP() << "only root can become somebody else";
  }
  const auto source = open();
  ASSERT_EQ(chmod(folder_.c_str(), 0755) + chmod(path().c_str(), 0666), 0);
  const pid_t child = fork();
  if (child == 0) {
    const bool other = setgid(65534) == 0 && setuid(65534) == 0;
    EXPECT_TRUE(sender()->write(batch_of({"stranger"}, 0ms)));
    _exit(other ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  DatagramBatch batch;
  EXPECT_THAT(read(*source, batch), ElementsAre());
  EXPECT_THAT(source->counters().rejected, ElementsAre(Pair("stranger", 1U)));
}

TEST_F(UnixSourceTest, ReplacesOnlyUnusedSockets) {
  {
    const auto first = open();
    const auto second = UnixSource::open({.path = path()});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(second.error().message, HasSubstr("in use"));
  }
  EXPECT_FALSE(std::filesystem::exists(path()));
  // As a killed process leaves it.
  const int fd = socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path().copy(&address.sun_path[0], sizeof address.sun_path - 1);
  ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  close(fd);
  EXPECT_NE(open(), nullptr);
  EXPECT_THAT(UnixSource::open({.path = folder_ + "/no/folder"}).error().message,
              HasSubstr("No such file"));
  EXPECT_EQ(UnixSource::open({.path = std::string(200, 'x')}).error().kind, ErrorKind::kUsage);
  EXPECT_EQ(RelaySender::open(std::string(200, 'x')).error().kind, ErrorKind::kUsage);
}

TEST_F(UnixSourceTest, TakesASocketThatSystemdPasses) {
  const int fd = socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path().copy(&address.sun_path[0], sizeof address.sun_path - 1);
  ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  auto source = UnixSource::open({.adopted_fd = fd});
  ASSERT_TRUE(source) << source.error().message;
  const auto relay = sender();
  EXPECT_TRUE(relay->write(batch_of({"passed"}, 0ms)));
  DatagramBatch batch;
  EXPECT_THAT(read(**source, batch), ElementsAre("passed"));
  source->reset();
  EXPECT_TRUE(std::filesystem::exists(path())) << "it is systemd's";
  const auto udp = UnixSource::open({.adopted_fd = socket(AF_INET, SOCK_DGRAM, 0)});
  ASSERT_FALSE(udp);
  EXPECT_THAT(udp.error().message, HasSubstr("ListenDatagram"));
}

}  // namespace
}  // namespace rayloc::unix_source_test
