// PcapLiveSource on the loopback interface; needs CAP_NET_RAW, which CI's root has.
#include "capture/source/pcap_live_source.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "capture/source/udp_source.h"
#include "tests/support/patience.h"

namespace rayloc::pcap_live_source_test {
namespace {

using ::testing::HasSubstr;

// A socket that owns a port on lo, and one that sends to it.
class PcapLiveSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto receiver = UdpSource::open({.address = "127.0.0.1:0"});
    ASSERT_TRUE(receiver) << receiver.error().message;
    receiver_ = std::move(*receiver);
    filter_ = "udp dst port " + std::to_string(receiver_->port());
    auto source = PcapLiveSource::open({.interface = "lo", .filter = filter_});
    if (!source && geteuid() != 0) {
      EXPECT_THAT(source.error().message, HasSubstr("cap_net_raw"));
      EXPECT_EQ(source.error().kind, ErrorKind::kUnavailable);
      GTEST_SKIP() << source.error().message;
    }
    if (!source) {
      GTEST_SKIP() << "no packet sockets here: " << source.error().message;
    }
    source_ = std::move(*source);
  }

  void send(const std::string& payload) const {
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(receiver_->port());
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(sendto(fd,
                     payload.data(),
                     payload.size(),
                     0,
                     reinterpret_cast<const sockaddr*>(&to),
                     sizeof to),
              static_cast<ssize_t>(payload.size()));
    close(fd);
  }

  std::string filter_;
  std::unique_ptr<UdpSource> receiver_;
  std::unique_ptr<PcapLiveSource> source_;
};

TEST_F(PcapLiveSourceTest, DeliversEachDatagramOnceWithTheTimeOfTheSocket) {
  for (const char* payload : {"one", "", "three"}) {
    send(payload);
  }
  std::vector<std::string> payloads;
  std::vector<Timestamp> times;
  DatagramBatch batch;
  while (payloads.size() < 3) {
    ASSERT_TRUE(source_->read(batch, test::patient(std::chrono::seconds(10))));
    ASSERT_FALSE(batch.datagrams.empty()) << "nothing came";
    for (const Datagram& d : batch.datagrams) {
      payloads.emplace_back(reinterpret_cast<const char*>(d.payload.data()), d.payload.size());
      times.push_back(d.time);
      EXPECT_EQ(d.address.destination_port, receiver_->port());
      EXPECT_EQ(d.address.source_ip, INADDR_LOOPBACK);
      EXPECT_EQ(d.time.time_since_epoch() % std::chrono::microseconds(1), Duration(0));
    }
  }
  EXPECT_THAT(payloads, ::testing::ElementsAre("one", "", "three"));
  ASSERT_TRUE(source_->read(batch, Duration(0)));
  EXPECT_TRUE(batch.datagrams.empty());
  EXPECT_GT(batch.watermark, times.back() - std::chrono::seconds(1));
  const SourceCounters counters = source_->counters();
  EXPECT_EQ(counters.received, 3U);
  EXPECT_EQ(counters.delivered, 3U);
  EXPECT_EQ(counters.bytes, 8U);
  EXPECT_EQ(counters.kernel_drops, 0U);
}

TEST_F(PcapLiveSourceTest, RefusesAFilterThatIsNone) {
  const auto source = PcapLiveSource::open({.interface = "lo", .filter = "udp prt 5500"});
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(source.error().message, HasSubstr("'udp prt 5500'"));
}

TEST_F(PcapLiveSourceTest, RefusesAnInterfaceThatIsNotThere) {
  const auto source = PcapLiveSource::open({.interface = "nowhere0"});
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(source.error().message, HasSubstr("nowhere0"));
}

}  // namespace
}  // namespace rayloc::pcap_live_source_test
