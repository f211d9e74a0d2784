// UdpSource over real loopback sockets.
#include "capture/udp_source.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <numeric>
#include <string>
#include <thread>

#include "capture/udp_address.h"

namespace rayloc {
namespace {

using ::testing::HasSubstr;
constexpr Duration kNoWait{0};
constexpr Duration kLong = std::chrono::seconds(10);

// Sends to 127.0.0.1:`port`.
class Sender {
 public:
  explicit Sender(std::uint16_t port) : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  ~Sender() { close(fd_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void send(const std::string& payload) const {
    ASSERT_EQ(::send(fd_, payload.data(), payload.size(), 0), static_cast<ssize_t>(payload.size()));
  }
  std::uint16_t port() const {
    sockaddr_in own{};
    socklen_t size = sizeof own;
    EXPECT_EQ(getsockname(fd_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    return ntohs(own.sin_port);
  }

 private:
  int fd_;
};

std::unique_ptr<UdpSource> open_source(UdpSourceOptions options = {}) {
  options.address = "127.0.0.1:0";
  auto source = UdpSource::open(options);
  if (!source) {
    ADD_FAILURE() << source.error().message;
    std::abort();
  }
  return std::move(*source);
}

std::string text(const Datagram& datagram) {
  return {reinterpret_cast<const char*>(datagram.payload.data()), datagram.payload.size()};
}

Timestamp now() { return std::chrono::system_clock::now(); }

std::uint64_t rejected(const SourceCounters& counters) {
  return std::accumulate(counters.rejected.begin(),
                         counters.rejected.end(),
                         std::uint64_t{0},
                         [](auto n, const auto& c) { return n + c.second; });
}

TEST(UdpSource, DeliversWhatArrivesInOrderWithAddressesAndMicroseconds) {
  const auto source = open_source();
  const Sender sender(source->port());
  const Timestamp before = now();
  sender.send("one");
  sender.send("");
  sender.send(std::string(UdpSource::kMaxDatagramBytes, 'x'));
  DatagramBatch batch;
  ASSERT_TRUE(source->read(batch, kLong));
  ASSERT_EQ(batch.datagrams.size(), 3U);
  EXPECT_EQ(text(batch.datagrams[0]), "one");
  EXPECT_EQ(text(batch.datagrams[1]), "");
  EXPECT_EQ(text(batch.datagrams[2]), std::string(UdpSource::kMaxDatagramBytes, 'x'));
  EXPECT_FALSE(batch.ended);
  for (const Datagram& datagram : batch.datagrams) {
    EXPECT_EQ(datagram.address,
              (DatagramAddress{.source_ip = INADDR_LOOPBACK,
                               .destination_ip = INADDR_LOOPBACK,
                               .source_port = sender.port(),
                               .destination_port = source->port()}));
    EXPECT_EQ(datagram.time.time_since_epoch() % std::chrono::microseconds(1), Duration(0));
    EXPECT_GE(datagram.time, before - std::chrono::milliseconds(1));
    EXPECT_LE(datagram.time, now());
  }
  const SourceCounters counters = source->counters();
  EXPECT_EQ(rejected(counters), 0U);
  EXPECT_EQ(counters.received, 3U);
  EXPECT_EQ(counters.delivered, 3U);
  EXPECT_EQ(counters.bytes, 3U + UdpSource::kMaxDatagramBytes);
  EXPECT_EQ(counters.kernel_drops, 0U);
}

TEST(UdpSource, WatermarkOfAnIdleSocketAdvances) {
  const auto source = open_source();
  DatagramBatch batch;
  ASSERT_TRUE(source->read(batch, kNoWait));
  EXPECT_TRUE(batch.datagrams.empty());
  const Timestamp first = batch.watermark;
  const Timestamp before = now();
  ASSERT_TRUE(source->read(batch, std::chrono::milliseconds(5)));
  EXPECT_GT(batch.watermark, first);
  EXPECT_GT(batch.watermark, before - std::chrono::milliseconds(10));
  EXPECT_LT(batch.watermark, now());
}

}  // namespace
}  // namespace rayloc
