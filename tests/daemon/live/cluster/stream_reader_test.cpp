#include "daemon/live/cluster/stream_reader.h"

#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/support/patience.h"

namespace rayloc::stream_reader_test {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;

constexpr std::chrono::seconds kPatience{20};

class Stream : public ::testing::Test {
 protected:
  Stream() { make(); }
  void make() {
    StreamOptions options;
    options.name = "S";
    options.subjects = "in.>";
    options.republish_to = "again.>";
    ASSERT_TRUE(broker_->ensure_stream(options));
    publisher_ = *broker_->acked_publisher([](std::uint64_t, const std::string&) {});
  }
  std::unique_ptr<StreamReader> open(StreamReader::Place after = {},
                                     std::size_t max_waiting_bytes = 1 << 20,
                                     std::size_t max_requested_bytes = 1 << 20) {
    StreamReader::Options options;
    options.stream = "S";
    options.again = "again.>";
    options.after = after;
    options.quiet = milliseconds(50);
    options.max_waiting_bytes = max_waiting_bytes;
    options.max_requested_bytes = max_requested_bytes;
    return *StreamReader::open(broker_, options);
  }
  // The broker stores no message twice.
  void store(const std::string& data) {
    ++ids_;
    ASSERT_TRUE(publisher_->publish("in.x", data, std::to_string(ids_), ids_));
  }
  static auto next(StreamReader& reader) { return reader.next(test::patient(kPatience)); }
  // So many messages, however late they come, and what comes soon behind them.
  static std::vector<std::string> read(StreamReader& reader, std::size_t count) {
    std::vector<std::string> all;
    for (auto message = next(reader); message;
         message = all.size() < count ? next(reader) : reader.next(milliseconds(100))) {
      all.push_back(message->data);
    }
    return all;
  }

  std::shared_ptr<FakeBroker> broker_ = std::make_shared<FakeBroker>();
  std::unique_ptr<Broker::AckedPublisher> publisher_;
  std::uint64_t ids_ = 0;
};

TEST_F(Stream, IsReadFromItsBeginningAndOn) {
  store("a");
  store("b");
  const auto reader = open();
  store("c");
  EXPECT_THAT(read(*reader, 3), ElementsAre("a", "b", "c"));
  store("d");
  EXPECT_THAT(read(*reader, 1), ElementsAre("d"));
  EXPECT_EQ(reader->place().sequence, 4U);
  EXPECT_EQ(reader->counters().lost, 0U);
  const StreamReader::Place place = reader->place();
  store("e");
  EXPECT_THAT(read(*open(place), 1), ElementsAre("e"));
}

TEST_F(Stream, DoesNotRequestDeliveredMessages) {
  const auto reader = open();
  EXPECT_FALSE(reader->next(milliseconds(1)));
  for (int i = 0; i < 50; ++i) {
    store("x");
    ASSERT_TRUE(next(*reader));
  }
  EXPECT_EQ(reader->counters().asked_for, 0U);
}

// As many messages as fit into one request, and none twice.
TEST_F(Stream, CatchesUpByOneRequest) {
  constexpr std::size_t kStored = 300;
  for (std::size_t i = 0; i < kStored; ++i) {
    store(std::to_string(i));
  }
  const auto reader = open({{}, 100});
  for (std::size_t i = 100; i < kStored; ++i) {
    const auto message = next(*reader);
    ASSERT_TRUE(message);
    ASSERT_EQ(message->data, std::to_string(i));
  }
  EXPECT_EQ(broker_->gets(), 1U);
  EXPECT_EQ(reader->counters().asked_for, kStored - 100);
  store("then");
  EXPECT_THAT(read(*reader, 1), ElementsAre("then"));
  EXPECT_EQ(reader->counters().lost, 0U);
}

TEST_F(Stream, CatchesUpOneByOneWithAnOldServer) {
  broker_->set_giving_several(false);
  for (const char* const word : {"a", "b", "c", "d", "e"}) {
    store(word);
  }
  const auto reader = open();
  for (const char* const word : {"a", "b", "c", "d", "e"}) {
    const auto message = next(*reader);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->data, word);
  }
  EXPECT_EQ(broker_->gets(), 5U);
}

TEST_F(Stream, LimitsARequestByBytes) {
  for (int i = 0; i < 8; ++i) {
    store("1234567890");
  }
  const auto reader = open({}, 1 << 20, 25);
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(next(*reader));
  }
  EXPECT_EQ(broker_->gets(), 3U);
}

// A request for a hole gives no message that is there already.
TEST_F(Stream, RequestsNoMoreThanTheHole) {
  const auto reader = open({}, 4);
  for (const char* const word : {"aaa", "bbb", "ccc"}) {
    store(word);
  }
  ASSERT_TRUE(next(*reader));
  store("d");
  store("e");
  EXPECT_THAT(read(*reader, 4), ElementsAre("bbb", "ccc", "d", "e"));
  EXPECT_EQ(reader->counters().asked_for, 2U);
}

TEST_F(Stream, RequestsTheOverflowLater) {
  const auto reader = open({}, 2);
  for (const char* const word : {"a", "b", "c", "d", "e"}) {
    store(word);
  }
  EXPECT_THAT(read(*reader, 5), ElementsAre("a", "b", "c", "d", "e"));
  EXPECT_GT(reader->counters().asked_for, 0U);
}

TEST_F(Stream, CountsMessagesRemovedByRetentionAsLost) {
  const auto reader = open();
  store("a");
  EXPECT_THAT(read(*reader, 1), ElementsAre("a"));
  broker_->set_connected(false);
  broker_->set_connected(true);
  for (int i = 0; i < 5; ++i) {
    store("x");
  }
  const StreamReader::Place place = reader->place();
  for (std::uint64_t sequence = 1; sequence <= 4; ++sequence) {
    broker_->drop("S", sequence);
  }
  const auto successor = open(place);
  EXPECT_THAT(read(*successor, 2), ElementsAre("x", "x"));
  EXPECT_EQ(successor->counters().lost, 3U);
  EXPECT_EQ(open()->place().sequence, 0U);
}

TEST_F(Stream, AMissingMessageDoesNotBlockLaterOnes) {
  for (const char* const word : {"a", "b", "c"}) {
    store(word);
  }
  broker_->drop("S", 2);
  const auto reader = open();
  store("d");
  EXPECT_THAT(read(*reader, 3), ElementsAre("a", "c", "d"));
  EXPECT_EQ(reader->counters().lost, 1U);
}

// One replica was cut off for a while, and receives the missed messages late.
TEST_F(Stream, ReadsFromTheLeaderIfAReplicaLagsBehind) {
  for (const char* const word : {"a", "b", "c"}) {
    store(word);
  }
  broker_->set_lagging(1, FakeBroker::kAll);
  const auto reader = open();
  store("d");
  EXPECT_THAT(read(*reader, 4), ElementsAre("a", "b", "c", "d"));
  EXPECT_EQ(reader->counters().lost, 0U);
}

// A leader that was cut off lacks the messages that the others have stored since.
TEST_F(Stream, DoesNotAcceptALeaderBehindItsOwnPosition) {
  const auto reader = open();
  for (const char* const word : {"a", "b", "c"}) {
    store(word);
  }
  EXPECT_THAT(read(*reader, 3), ElementsAre("a", "b", "c"));
  broker_->set_lagging(1, 1);
  broker_->set_connected(false);
  broker_->set_connected(true);
  EXPECT_FALSE(reader->next(milliseconds(1500)));
  EXPECT_EQ(reader->counters().streams, 0U);
  broker_->set_lagging(FakeBroker::kAll, FakeBroker::kAll);
  store("d");
  EXPECT_THAT(read(*reader, 1), ElementsAre("d"));
  EXPECT_EQ(reader->counters().lost, 0U);
}

TEST_F(Stream, GoesOnAfterTheBrokerWasAway) {
  const auto reader = open();
  store("a");
  EXPECT_THAT(read(*reader, 1), ElementsAre("a"));
  broker_->set_connected(false);
  EXPECT_FALSE(reader->next(milliseconds(50)));
  broker_->set_connected(true);
  store("b");
  EXPECT_THAT(read(*reader, 1), ElementsAre("b"));
}

TEST_F(Stream, AnotherOneOfThatNameIsReadFromItsBeginning) {
  const auto reader = open();
  store("a");
  store("b");
  EXPECT_THAT(read(*reader, 2), ElementsAre("a", "b"));
  broker_->forget_streams();
  make();
  store("c");
  EXPECT_THAT(read(*reader, 1), ElementsAre("c"));
  EXPECT_EQ(reader->counters().streams, 1U);
  EXPECT_EQ(reader->place().sequence, 1U);
}

TEST_F(Stream, ReportsAMissingStream) {
  broker_->forget_streams();
  const auto reader = open();
  EXPECT_FALSE(reader->next(milliseconds(10)));
  EXPECT_NE(reader->trouble(), "");
  make();
  store("a");
  EXPECT_THAT(read(*reader, 1), ElementsAre("a"));
  EXPECT_EQ(reader->trouble(), "");
}

}  // namespace
}  // namespace rayloc::stream_reader_test
