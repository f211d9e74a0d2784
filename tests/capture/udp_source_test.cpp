// UdpSource over real loopback sockets.
#include "capture/source/udp_source.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <numeric>
#include <string>
#include <thread>

#include "capture/transport/udp_address.h"
#include "tests/support/patience.h"

namespace rayloc::udp_source_test {
namespace {

using ::testing::HasSubstr;
constexpr Duration kNoWait{0};
const Duration kLong = test::patient(std::chrono::seconds(10));

// Sends to 127.0.0.1:`port`, from an address of lo.
class Sender {
 public:
  explicit Sender(std::uint16_t port, std::uint32_t from = INADDR_LOOPBACK)
      : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(from);
    EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
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

TEST(UdpSource, DeliversDatagramsInOrderWithAddressesAndMicroseconds) {
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

TEST(UdpSource, RejectsOversizedDatagrams) {
  const auto source = open_source();
  const Sender sender(source->port());
  sender.send(std::string(UdpSource::kMaxDatagramBytes + 1, 'x'));
  sender.send("good");
  DatagramBatch batch;
  ASSERT_TRUE(source->read(batch, kLong));
  ASSERT_EQ(batch.datagrams.size(), 1U);
  EXPECT_EQ(text(batch.datagrams[0]), "good");
  const SourceCounters counters = source->counters();
  EXPECT_EQ(counters.rejected.at("oversized"), 1U);
  EXPECT_EQ(counters.received, counters.delivered + rejected(counters));
}

TEST(UdpSource, AcceptsDatagramsOfTheConfiguredInterface) {
  const auto source = open_source({.interface = "lo"});
  const Sender sender(source->port());
  sender.send("over lo");
  DatagramBatch batch;
  ASSERT_TRUE(source->read(batch, kLong));
  EXPECT_EQ(batch.datagrams.size(), 1U);
}

TEST(UdpSource, RejectsDatagramsOfAnotherInterface) {
  const unsigned other = if_nametoindex("lo") == 1 ? 2 : 1;
  std::array<char, IF_NAMESIZE> name{};
  if (if_indextoname(other, name.data()) == nullptr) {
    GTEST_SKIP() << "this machine has no interface besides lo";
  }
  const auto source = open_source({.interface = name.data()});
  const Sender sender(source->port());
  sender.send("over lo");
  DatagramBatch batch;
  ASSERT_TRUE(source->read(batch, kLong));
  EXPECT_TRUE(batch.datagrams.empty());
  const SourceCounters counters = source->counters();
  EXPECT_EQ(counters.received, 1U);
  EXPECT_EQ(counters.rejected.at("interface_not_allowed"), 1U);
}

TEST(UdpSource, RejectsSendersThatAreNotAllowed) {
  const auto source = open_source(
      {.senders = {*AddressRange::parse("127.0.0.2"), *AddressRange::parse("127.0.1.0/24")}});
  const Sender stranger(source->port());
  const Sender first(source->port(), 0x7f000002);
  const Sender second(source->port(), 0x7f000103);
  first.send("one");
  stranger.send("not this");
  second.send("two");
  DatagramBatch batch;
  ASSERT_TRUE(source->read(batch, kLong));
  ASSERT_EQ(batch.datagrams.size(), 2U);
  EXPECT_EQ(text(batch.datagrams[0]), "one");
  EXPECT_EQ(text(batch.datagrams[1]), "two");
  const SourceCounters counters = source->counters();
  EXPECT_EQ(counters.received, 3U);
  EXPECT_EQ(counters.rejected.at("sender_not_allowed"), 1U);
  EXPECT_EQ(rejected(counters), 1U);
}

TEST(UdpSource, RefusesAnInterfaceThatIsNotThere) {
  const auto source = UdpSource::open({.address = "127.0.0.1:0", .interface = "nowhere0"});
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(source.error().message, HasSubstr("'nowhere0'"));
}

TEST(UdpSource, RefusesAPortThatIsTaken) {
  const auto first = open_source();
  const std::string address = "127.0.0.1:" + std::to_string(first->port());
  const auto second = UdpSource::open({.address = address});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(second.error().message, HasSubstr(address));
}

TEST(UdpSource, CountsEveryDatagramThatTheKernelDrops) {
  const auto source = open_source({.receive_buffer_bytes = 1});  // the kernel's least: 2304 bytes
  const Sender sender(source->port());
  constexpr std::uint64_t kSent = 1000;
  DatagramBatch batch;
  std::uint64_t delivered = 0;
  for (std::uint64_t i = 0; i < kSent; ++i) {
    sender.send(std::string(300, 'x'));
    if (i == kSent / 2) {  // room again, and more drops after the last that fits
      ASSERT_TRUE(source->read(batch, kLong));
      delivered += batch.datagrams.size();
    }
  }
  do {
    ASSERT_TRUE(source->read(batch, kNoWait));
    delivered += batch.datagrams.size();
  } while (!batch.datagrams.empty());
  const SourceCounters counters = source->counters();
  EXPECT_GT(counters.kernel_drops, 0U);
  EXPECT_GT(delivered, 0U);
  EXPECT_EQ(counters.delivered, delivered);
  EXPECT_EQ(counters.received + counters.kernel_drops, kSent);
}

// As systemd passes it, bound to 127.0.0.1; its port in `port`.
int bound_socket(std::uint16_t& port) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), size), 0);
  EXPECT_EQ(getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size), 0);
  port = ntohs(address.sin_port);
  return fd;
}

// The socket outlives the daemons that read it, and the kernel counts from its beginning.
TEST(UdpSource, DoesNotCountEarlierLossesOfAnAdoptedSocket) {
  std::uint16_t port = 0;
  const int fd = bound_socket(port);
  const int smallest = 1;
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &smallest, sizeof smallest);
  const Sender sender(port);
  constexpr std::uint64_t kBefore = 50;
  for (std::uint64_t i = 0; i < kBefore; ++i) {
    sender.send(std::string(300, 'x'));
  }
  auto source = UdpSource::open({.adopted_fd = fd, .receive_buffer_bytes = smallest});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_GT((*source)->receive_buffer().dropped_before, 0U);
  DatagramBatch batch;
  ASSERT_TRUE((*source)->read(batch, kLong));
  EXPECT_EQ(batch.datagrams.size() + (*source)->receive_buffer().dropped_before, kBefore);
  EXPECT_EQ((*source)->counters().kernel_drops, 0U);
  constexpr std::uint64_t kAfter = 70;
  for (std::uint64_t i = 0; i < kAfter; ++i) {
    sender.send(std::string(300, 'x'));
  }
  const std::uint64_t received_before = (*source)->counters().received;
  do {
    ASSERT_TRUE((*source)->read(batch, kNoWait));
  } while (!batch.datagrams.empty());
  const SourceCounters counters = (*source)->counters();
  EXPECT_GT(counters.kernel_drops, 0U);
  EXPECT_EQ(counters.received - received_before + counters.kernel_drops, kAfter);
}

// systemd may enlarge it (ReceiveBuffer=), a daemon without CAP_NET_ADMIN may not.
TEST(UdpSource, LeavesAnAdoptedSocketItsLargerBuffer) {
  std::uint16_t port = 0;
  const int fd = bound_socket(port);
  const int bytes = 100'000;
  ASSERT_EQ(setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes), 0);
  const auto source = UdpSource::open({.adopted_fd = fd, .receive_buffer_bytes = 5000});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->receive_buffer().granted_bytes, bytes);
}

TEST(UdpSource, IsWokenFromAnotherThread) {
  const auto source = open_source();
  std::thread waker([&source] { source->wake(); });
  DatagramBatch batch;
  ASSERT_TRUE(source->read(batch, std::chrono::hours(1)));  // would run into the test's time-out
  EXPECT_TRUE(batch.datagrams.empty());
  waker.join();
}

TEST(UdpSource, TakesOverASocketThatIsBoundToBothFamilies) {
  const int fd = socket(AF_INET6, SOCK_DGRAM, 0);
  if (fd < 0) {
    GTEST_SKIP() << "this machine has no IPv6";
  }
  const int off = 0;
  setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  sockaddr_in6 any{};
  any.sin6_family = AF_INET6;
  ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&any), sizeof any), 0);
  auto source = UdpSource::open({.adopted_fd = fd});
  ASSERT_TRUE(source) << source.error().message;
  const Sender sender((*source)->port());
  sender.send("mapped");
  DatagramBatch batch;
  ASSERT_TRUE((*source)->read(batch, kLong));
  ASSERT_EQ(batch.datagrams.size(), 1U);
  EXPECT_EQ(batch.datagrams[0].address.source_ip, INADDR_LOOPBACK);
  EXPECT_EQ(batch.datagrams[0].address.source_port, sender.port());
  EXPECT_EQ(batch.datagrams[0].address.destination_ip, INADDR_LOOPBACK);
}

TEST(Field, AnIpv6AddressOfAUdpEndpointIsNamedAsSuch) {
  for (const char* text : {"[::1]:5500", "[fe80::1%eth0]:5500", "::1:5500", "[::]:5500"}) {
    const auto address = parse_udp_address(text);
    ASSERT_FALSE(address) << text;
    EXPECT_THAT(address.error().message, HasSubstr("IPv6")) << text;
    EXPECT_THAT(address.error().message, HasSubstr("HOST:PORT")) << text;
  }
  EXPECT_EQ(to_string(*parse_udp_address("localhost:5500")), "127.0.0.1:5500");
}

TEST(UdpAddress, ReportsInvalidAddresses) {
  for (const char* text : {"",
                           "5500",
                           "127.0.0.1",
                           "127.0.0.1:",
                           "127.0.0.1:x",
                           "1.2.3.4:65536",
                           "1.2.3.4:5500 ",
                           "no.such.host.invalid:1"}) {
    const auto address = parse_udp_address(text);
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(address.error().message, HasSubstr("HOST:PORT"));
  }
  EXPECT_EQ(to_string(*parse_udp_address("*:5500")), "0.0.0.0:5500");
  EXPECT_EQ(to_string(*parse_udp_address(":1")), "0.0.0.0:1");
  EXPECT_EQ(to_string(*parse_udp_address("255.255.255.255:65535")), "255.255.255.255:65535");
}

}  // namespace
}  // namespace rayloc::udp_source_test
