// Requests for several messages of a stream, to a real server: one of 2.11 on gives as many as are
// asked for, an older one gives one for each request.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "tests/cluster/nats_server.h"
#include "tests/support/eventually.h"

namespace rayloc::cluster::batch_get_test {
namespace {

constexpr std::chrono::seconds kPatience{30};

class BatchGet : public ::testing::Test {
 protected:
  BatchGet() : folder_(::testing::TempDir() + "/batch_get_test." + std::to_string(::getpid())) {
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<NatsServer>(folder_);
  }
  void TearDown() override {
    server_->kill();
    std::filesystem::remove_all(folder_);
  }
  std::shared_ptr<Broker> connect() {
    auto broker = open_broker({{server_->url()}, "test", "test"});
    EXPECT_TRUE(broker) << broker.error().message;
    EXPECT_TRUE(eventually(kPatience, [&] { return (*broker)->connected(); }));
    return *broker;
  }

  std::filesystem::path folder_;
  std::unique_ptr<NatsServer> server_;
};

// A stream of `count` messages, whose data are their sequences.
std::string numbered_stream(Broker& broker, std::uint64_t count) {
  const StreamOptions stream = site_stream("lab", {});
  EXPECT_TRUE(broker.ensure_stream(stream));
  std::uint64_t last = 0;
  for (std::uint64_t sequence = 1; sequence <= count; ++sequence) {
    const auto stored = broker.publish_behind(
        csi_subject("lab", "node1"), std::to_string(sequence) + std::string(1000, '.'), last);
    EXPECT_TRUE(stored && stored->is_last);
    last = sequence;
  }
  return stream.name;
}

TEST_F(BatchGet, GivesSeveralMessagesOrOneByOne) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  const std::string stream = numbered_stream(*broker, 12);
  std::vector<std::uint64_t> sequences;
  for (std::uint64_t next = 3; next <= 12; next = sequences.back() + 1) {
    const auto some = broker->get_several(stream, {next, 5, std::size_t{1} << 20U});
    ASSERT_TRUE(some) << some.error().message;
    ASSERT_FALSE(some->empty());
    for (const BrokerMessage& one : *some) {
      EXPECT_EQ(one.subject, csi_subject("lab", "node1"));
      EXPECT_EQ(std::to_string(one.sequence) + std::string(1000, '.'), one.data);
      sequences.push_back(one.sequence);
    }
  }
  EXPECT_THAT(sequences, ::testing::ElementsAre(3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
  const auto none = broker->get_several(stream, {13, 5, 1000});
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->empty());
  EXPECT_FALSE(broker->get_several("no_such", {1, 5, 1000}));
}

// Skipped, by name, if the server is older than 2.11.
TEST_F(BatchGet, GivesManyMessagesByOneRequest) {
  RAYLOC_NEEDS_NATS_SERVER();
  int major = 0;
  int minor = 0;
  const std::string version = NatsServer::version();
  if (std::sscanf(version.c_str(), "%d.%d", &major, &minor) != 2 ||
      std::pair(major, minor) < std::pair(2, 11)) {
    GTEST_SKIP() << "nats-server " << version
                 << " gives one message for a request: name one of 2.11 on in RAYLOC_NATS_SERVER";
  }
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  constexpr std::uint64_t kMany = 200;
  const std::string stream = numbered_stream(*broker, kMany);
  const auto all = broker->get_several(stream, {1, 2 * kMany, std::size_t{1} << 20U});
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->size(), kMany);
  EXPECT_EQ(all->back().sequence, kMany);
  const auto some = broker->get_several(stream, {101, 7, std::size_t{1} << 20U});
  ASSERT_TRUE(some);
  ASSERT_EQ(some->size(), 7U);
  EXPECT_EQ(some->front().sequence, 101U);
  const auto few = broker->get_several(stream, {101, 50, 2500});  // bytes, of some 1000 each
  ASSERT_TRUE(few);
  EXPECT_EQ(few->size(), 3U);
  // The first message must exist.
  ASSERT_TRUE(broker->ask("$JS.API.STREAM.MSG.DELETE." + stream, R"({"seq": 101})"));
  const auto removed = broker->get_several(stream, {101, 7, 10'000});
  ASSERT_TRUE(removed);
  EXPECT_TRUE(removed->empty() || removed->front().sequence > 101);
}

}  // namespace
}  // namespace rayloc::cluster::batch_get_test
