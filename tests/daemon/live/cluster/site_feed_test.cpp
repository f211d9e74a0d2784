#include "daemon/live/cluster/site_feed.h"

#include <poll.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/daemon/live/cluster/some_batch.h"
#include "tests/support/eventually.h"

namespace rayloc::site_feed_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr seconds kPatience{20};

class Feed : public ::testing::Test {
 protected:
  void open(std::vector<std::string> access_points,
            Duration silent_after = seconds(60),
            ShedRule::Limits shed = {}) {
    SiteFeed::Options options;
    options.site = "office";
    options.stream = site_stream("office", {});
    options.access_points = std::move(access_points);
    options.silent_after = silent_after;
    options.shed = shed;
    options.ask_after = milliseconds(10);
    ASSERT_TRUE(broker_->ensure_stream(options.stream));
    publisher_ = *broker_->acked_publisher([](std::uint64_t, const std::string&) {});
    for (std::size_t i = 0; i < options.access_points.size(); ++i) {
      received_.emplace_back();
    }
    feed_ = *SiteFeed::open(broker_, options);
    for (std::size_t i = 0; i < received_.size(); ++i) {
      sources_.push_back(feed_->source(i));
    }
    feed_->start();
  }
  // Stores a batch of that node; its time is 20 ms times its number, after a fixed start.
  void store(const std::string& node, const Batch& batch) { store(node, encode(batch)); }
  void store(const std::string& node, const std::string& bytes) {
    ++ids_;
    ASSERT_TRUE(
        publisher_->publish(csi_subject("office", node), bytes, std::to_string(ids_), ids_));
  }
  // Stores a record that only the owner of the site may write.
  void store(const v1::OwnerRecord& record) {
    ++ids_;
    ASSERT_TRUE(
        publisher_->publish(owner_subject("office"), seal(record), std::to_string(ids_), ids_));
  }
  struct Received {
    std::vector<Timestamp> times;
    std::size_t bytes = 0;
    Timestamp watermark = Timestamp::min();
  };
  // The datagrams and the watermark received so far from an access point.
  const Received& received(std::size_t i) {
    DatagramBatch batch;
    EXPECT_TRUE(sources_[i]->read(batch, milliseconds(1)));
    EXPECT_GE(batch.watermark, received_[i].watermark);
    received_[i].watermark = batch.watermark;
    for (const Datagram& one : batch.datagrams) {
      received_[i].times.push_back(one.time);
      received_[i].bytes += one.payload.size();
    }
    return received_[i];
  }
  static Timestamp time_of(std::uint64_t number) {
    return some_batch(number, {{"x", 1}}).parts[0].watermark;
  }

  std::shared_ptr<FakeBroker> broker_ = std::make_shared<FakeBroker>();
  std::unique_ptr<Broker::AckedPublisher> publisher_;
  std::vector<std::unique_ptr<DatagramSource>> sources_;
  std::vector<Received> received_;
  std::unique_ptr<SiteFeed> feed_;
  std::uint64_t ids_ = 0;
};

TEST_F(Feed, DeliversTheDatagramsOfEachAccessPoint) {
  open({"ap1", "ap2"});
  const Batch first = some_batch(1, {{"ap1", 3}, {"ap2", 2}});
  store("a", first);
  store("a", some_batch(2, {{"ap2", 1}}));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 3; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(1).times.size() == 3; }));
  EXPECT_EQ(received(0).bytes, first.parts[0].datagrams.payloads.size());
  EXPECT_EQ(received(0).times.front(), first.parts[0].datagrams.entries[0].time);
  EXPECT_EQ(received(0).watermark, first.parts[0].watermark);
  EXPECT_EQ(sources_[0]->counters().delivered, 3U);
  feed_->finish();
}

bool is_readable(const DatagramSource& source) {
  pollfd one{.fd = source.poll_descriptor().value_or(-1), .events = POLLIN, .revents = 0};
  return ::poll(&one, 1, 0) == 1;
}

// A shared thread polls it.
TEST_F(Feed, ASourceIsReadableWhileDataWait) {
  open({"ap1", "ap2"});
  ASSERT_TRUE(sources_[0]->poll_descriptor());
  EXPECT_FALSE(is_readable(*sources_[0]));
  store("a", some_batch(1, {{"ap1", 1}}));
  store("a", some_batch(2, {{"ap1", 1}}));
  ASSERT_TRUE(eventually(kPatience, [&] { return is_readable(*sources_[0]); }));
  ASSERT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 2; }));
  EXPECT_FALSE(is_readable(*sources_[0]));
  EXPECT_FALSE(is_readable(*sources_[1]));
}

TEST_F(Feed, RequestsMissingBatchesAndWaitsForThem) {
  open({"ap1"});
  std::atomic<int> asked{0};
  const auto requests = broker_->subscribe(resend_subject("a"), [&](BrokerMessage&&) { ++asked; });
  store("a", some_batch(1, {{"ap1", 1}}));
  store("a", some_batch(3, {{"ap1", 1}}));
  ASSERT_TRUE(eventually(kPatience, [&] { return asked > 0; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 1; }));
  store("a", some_batch(2, {{"ap1", 1}}));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 3; }));
  EXPECT_TRUE(std::is_sorted(received(0).times.begin(), received(0).times.end()));
}

TEST_F(Feed, DoesNotWaitForAnAccessPointWithoutANode) {
  open({"ap1", "ap9"});
  store("a", some_batch(5, {{"ap1", 1}}));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(1).watermark == time_of(5); }));
}

TEST_F(Feed, DoesNotWaitForASilentNodeUntilItReturns) {
  open({"ap1", "ap2"}, milliseconds(300));
  store("a", some_batch(1, {{"ap1", 1}}));
  store("b", some_batch(1, {{"ap2", 1}}));
  std::uint64_t number = 1;
  ASSERT_TRUE(eventually(kPatience, [&] {
    store("a", some_batch(++number, {{"ap1", 1}}));
    return received(1).watermark > time_of(1);
  }));
  EXPECT_TRUE(eventually(kPatience, [&] { return feed_->counters().silences == 1; }));
  const Timestamp promised = received(1).watermark;
  store("b", some_batch(2, {{"ap2", 4}}));  // received before the promised watermark
  store("b", some_batch(3, {{"ap2", 1}}));
  const Batch later = some_batch(number + 100, {{"ap2", 2}});
  Batch fourth = later;
  fourth.number = 4;
  store("b", fourth);
  EXPECT_TRUE(eventually(kPatience, [&] {
    return !received(1).times.empty() && received(1).times.back() == later.parts[0].watermark;
  }));
  EXPECT_GE(sources_[1]->counters().rejected["late_node"], 1U);
  // It is waited for again.
  store("a", some_batch(++number, {{"ap1", 1}}));
  EXPECT_GE(received(1).watermark, promised);
}

// A feed that resumes after the record leaves out the same batches.
TEST_F(Feed, ShedsFromTheRecordOnwards) {
  open({"ap1"});
  const auto store_some = [&](std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t number = from; number <= to; ++number) {
      store("a", some_batch(number, {{"ap1", 1}}));
    }
  };
  v1::OwnerRecord record;
  record.mutable_shed()->set_level(1);
  store_some(1, 30);
  ASSERT_TRUE(publisher_->publish(owner_subject("office"), seal(record), "shed", 1000));
  store_some(31, 130);
  // In windows of 20 batches, 2, 4 and 6 are used, and window 1 up to the record.
  ASSERT_TRUE(eventually(kPatience, [&] { return received(0).watermark == time_of(130); }));
  EXPECT_EQ(received(0).times.size(), 30U + 20 + 20 + 11);
  EXPECT_EQ(sources_[0]->counters().rejected["shed"], 9U + 20 + 20);
  EXPECT_EQ(feed_->counters().shed_level, 1U);

  SiteFeed::Options options;
  options.site = "office";
  options.stream = site_stream("office", {});
  options.access_points = {"ap1"};
  options.resume = resume_of(position_message(feed_->resume_for(time_of(90))));
  EXPECT_EQ(options.resume.shed_level, 1U);
  options.until = broker_->stream_state(options.stream.name)->last;
  const auto again = *SiteFeed::open(broker_, options);
  const auto source = again->source(0);
  again->start();
  std::vector<Timestamp> times;
  for (bool more = true; more;) {
    DatagramBatch batch;
    ASSERT_TRUE(source->read(batch, seconds(1)));
    more = !batch.ended;
    for (const Datagram& one : batch.datagrams) {
      times.push_back(one.time);
    }
  }
  const auto& all = received_[0].times;
  EXPECT_FALSE(times.empty());
  EXPECT_TRUE(std::equal(times.rbegin(), times.rend(), all.rbegin()));
}

TEST_F(Feed, RaisesTheShedLevelWhileFarBehind) {
  open({"ap1"}, seconds(60), {milliseconds(100), milliseconds(50), milliseconds(40)});
  store("a", some_batch(1, {{"ap1", 1}}));
  store("a", some_batch(2, {{"ap1", 1}}));
  feed_->note_done(time_of(2) - seconds(1));
  EXPECT_TRUE(eventually(kPatience, [&] { return feed_->counters().shed_level == kMaxShed; }));
  feed_->note_done(time_of(2));
  EXPECT_TRUE(eventually(kPatience, [&] { return feed_->counters().shed_level == 0; }));
}

TEST_F(Feed, CountsUnreadableMessages) {
  open({"ap1"});
  ASSERT_TRUE(publisher_->publish(csi_subject("office", "a"), "no batch", "x", 1));
  ASSERT_TRUE(publisher_->publish(owner_subject("office"), "no record", "y", 2));
  store("a", some_batch(1, {{"ap1", 1}, {"ap7", 5}}));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 1; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return feed_->counters().unknown == 5; }));
  EXPECT_EQ(feed_->counters().refused, 2U);
}

std::string changed(const Batch& batch, std::size_t byte) {
  std::string bytes = encode(batch);
  bytes.at(byte) = static_cast<char>(bytes.at(byte) ^ 0x10);
  return bytes;
}

// One has another version, one a changed byte. The node sends the first again, and marks the other.
TEST_F(Feed, ABatchThatIsRefusedIsReadAgainOrMarked) {
  constexpr std::size_t kVersionByte = 3;
  open({"ap1"});
  std::atomic<int> asked{0};
  const auto requests = broker_->subscribe(resend_subject("a"), [&](BrokerMessage&&) { ++asked; });
  const Batch second = some_batch(2, {{"ap1", 3}});
  const Batch third = some_batch(3, {{"ap1", 2}});
  store("a", some_batch(1, {{"ap1", 1}}));
  store("a", changed(second, kVersionByte));
  store("a", changed(third, encode(third).size() - 1));
  store("a", some_batch(4, {{"ap1", 1}}));
  ASSERT_TRUE(eventually(kPatience, [&] { return asked > 0; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 1; }));
  store("a", second);
  Batch fifth = some_batch(5, {{"ap1", 1}});
  fifth.gaps = {{3, 3, {{"ap1", 2}}, "no longer kept"}};
  store("a", fifth);
  EXPECT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 1 + 3 + 1 + 1; }));
  EXPECT_TRUE(std::is_sorted(received(0).times.begin(), received(0).times.end()));
  EXPECT_TRUE(eventually(kPatience, [&] { return feed_->counters().batches.taken == 4; }));
  const SiteFeed::Counters counters = feed_->counters();
  EXPECT_EQ(counters.refused, 2U);
  EXPECT_EQ(counters.batches.marked, 1U);
  EXPECT_EQ(counters.batches.marked_datagrams.at("ap1"), 2U);
  EXPECT_EQ(counters.batches.missing, 0U);
}

TEST_F(Feed, ANodeOfAnotherVersionDelaysNoOther) {
  constexpr std::size_t kVersionByte = 3;
  open({"ap1", "ap2"});
  for (std::uint64_t number = 1; number <= 3; ++number) {
    store("a", some_batch(number, {{"ap1", 1}}));
    store("b", changed(some_batch(number, {{"ap2", 1}}), kVersionByte));
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return received(0).times.size() == 3; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(1).watermark == time_of(3); }));
  EXPECT_THAT(received(1).times, IsEmpty());
  EXPECT_TRUE(eventually(kPatience, [&] { return feed_->counters().refused == 3; }));
}

// The records name another start or number of the node, or a node that is not there.
TEST_F(Feed, IgnoresForgedSilence) {
  open({"ap1", "ap2"});
  store("a", some_batch(1, {{"ap1", 1}}));
  store("b", some_batch(1, {{"ap2", 1}}));
  const auto silent = [](const std::string& node, std::uint64_t epoch, std::uint64_t number) {
    v1::OwnerRecord record;
    record.mutable_silent()->set_node(node);
    record.mutable_silent()->set_epoch(epoch);
    record.mutable_silent()->set_number(number);
    return record;
  };
  store(silent("b", kSomeEpoch + 1, 1));
  store(silent("b", kSomeEpoch, 2));
  store(silent("c", kSomeEpoch, 1));
  store("a", some_batch(2, {{"ap1", 1}}));
  ASSERT_TRUE(eventually(kPatience, [&] { return received(0).watermark == time_of(2); }));
  EXPECT_EQ(received(1).watermark, time_of(1)) << "it is still waited for";
  store(silent("b", kSomeEpoch, 1));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(1).watermark == time_of(2); }));
  EXPECT_TRUE(eventually(kPatience, [&] { return feed_->counters().silences == 1; }));
}

TEST_F(Feed, ShedsNoMoreThanItMayByAForgedRecord) {
  open({"ap1"});
  v1::OwnerRecord record;
  record.mutable_shed()->set_level(std::numeric_limits<std::uint32_t>::max());
  store(record);
  constexpr std::uint64_t kBatches = 400;
  for (std::uint64_t number = 1; number <= kBatches; ++number) {
    store("a", some_batch(number, {{"ap1", 1}}));
  }
  ASSERT_TRUE(eventually(kPatience, [&] { return received(0).watermark == time_of(kBatches); }));
  EXPECT_FALSE(received(0).times.empty());
  EXPECT_EQ(received(0).times.size() + sources_[0]->counters().rejected["shed"], kBatches);
  EXPECT_LE(feed_->counters().shed_level, kMaxShed);
}

// Nothing that it sent is used after its silence, and all of that is counted.
TEST_F(Feed, CountsTheDataOfANodeWhoseClockIsAnHourBehind) {
  open({"ap1", "ap2"}, milliseconds(300));
  const auto behind = [](std::uint64_t number, std::size_t datagrams) {
    Batch batch = some_batch(number, {{"ap2", datagrams}});
    batch.parts[0].watermark -= std::chrono::hours(1);
    for (auto& entry : batch.parts[0].datagrams.entries) {
      entry.time -= std::chrono::hours(1);
    }
    return batch;
  };
  store("b", behind(1, 2));
  store("a", some_batch(1, {{"ap1", 1}}));
  EXPECT_TRUE(eventually(kPatience, [&] { return received(1).times.size() == 2; }));
  EXPECT_LT(received(1).times.back(), time_of(1) - std::chrono::minutes(59));
  std::uint64_t number = 1;
  ASSERT_TRUE(eventually(kPatience, [&] {
    store("a", some_batch(++number, {{"ap1", 1}}));
    return received(1).watermark > time_of(1);
  }));
  store("b", behind(2, 4));
  EXPECT_TRUE(
      eventually(kPatience, [&] { return sources_[1]->counters().rejected["late_node"] == 4; }));
  EXPECT_EQ(received(1).times.size(), 2U);
}

TEST_F(Feed, AnAbsentBrokerIsTheTroubleOfEverySource) {
  open({"ap1"});
  EXPECT_EQ(sources_[0]->trouble(), "");
  broker_->set_connected(false);
  EXPECT_EQ(sources_[0]->trouble(), "no broker answers");
}

}  // namespace
}  // namespace rayloc::site_feed_test
