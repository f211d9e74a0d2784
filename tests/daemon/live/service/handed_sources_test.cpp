// Sources that pass from one start of a site to the next, and those that are closed.
#include "daemon/live/service/sources/handed_sources.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "capture/source/udp_source.h"
#include "capture/transport/udp_sender.h"

namespace rayloc::handed_sources_test {
namespace {

// The source of an access point at a free port.
class Port {
 public:
  explicit Port(const std::string& site) {
    auto opened = UdpSource::open({.address = "127.0.0.1:0"}).value();
    config.listen_host = "127.0.0.1";
    config.listen_port = opened->port();
    config.site = site;
    config.instance = site + "-ap1";
    source = std::move(opened);
  }

  void send(int datagrams) const {
    static constexpr std::array<std::byte, 8> kPayload{};
    DatagramBatch batch;
    batch.datagrams.assign(static_cast<std::size_t>(datagrams),
                           Datagram{.time = {}, .address = {}, .payload = kPayload});
    const auto sender = UdpSender::open("127.0.0.1:" + std::to_string(config.listen_port)).value();
    EXPECT_TRUE(sender->write(batch));
  }

  SourceConfig config;
  std::unique_ptr<DatagramSource> source;
};

std::size_t read_all(DatagramSource& source) {
  DatagramBatch batch;
  EXPECT_TRUE(source.read(batch, std::chrono::seconds(10)));
  return batch.datagrams.size();
}

TEST(HandedSources, ContinueWithQueuedDatagramsAndCountFromZero) {
  Port port("office");
  HandedSources handed;
  std::unique_ptr<DatagramSource> source = std::move(port.source);
  for (const int datagrams : {3, 4, 5}) {
    port.send(datagrams);
    EXPECT_EQ(read_all(*source), static_cast<std::size_t>(datagrams));
    EXPECT_EQ(source->counters().received, static_cast<std::uint64_t>(datagrams));
    EXPECT_EQ(source->counters().delivered, static_cast<std::uint64_t>(datagrams));
    handed.add(port.config, std::move(source));
    EXPECT_EQ(handed.close_others("office", {port.config}), 0U);
    source = handed.take(port.config);
    ASSERT_NE(source, nullptr);
    EXPECT_EQ(source->counters().received, 0U);
  }
  EXPECT_EQ(handed.take(port.config), nullptr) << "it is taken";
}

TEST(HandedSources, CountTheDatagramsOfUnclaimedSources) {
  Port port("office");
  Port other("lab");
  HandedSources handed;
  port.send(2);
  EXPECT_EQ(read_all(*port.source), 2U);
  port.send(7);
  other.send(1);
  handed.add(port.config, std::move(port.source));
  handed.add(other.config, std::move(other.source));
  SourceConfig changed = port.config;
  changed.allow = {"10.0.0.0/8"};
  EXPECT_EQ(handed.take(changed), nullptr) << "it would be opened otherwise";
  EXPECT_EQ(handed.close_others("office", {changed}), 7U);
  EXPECT_EQ(handed.take(port.config), nullptr);
  EXPECT_TRUE(UdpSource::open({.address = "127.0.0.1:" + std::to_string(port.config.listen_port)}))
      << "its port is free";
  EXPECT_NE(handed.take(other.config), nullptr) << "it is of another site";
}

}  // namespace
}  // namespace rayloc::handed_sources_test
