// A server whose store is full: the capture node and the owner of a site name the refusal, account
// for every datagram, and continue once there is space; nothing is stored or published twice.
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/batch.h"
#include "daemon/live/cluster/batch_sender.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/operate/stream_admin.h"
#include "daemon/live/cluster/ownership/out_stage.h"
#include "daemon/live/cluster/sealed_message.h"
#include "tests/cluster/nats_server.h"
#include "tests/daemon/live/cluster/some_batch.h"
#include "tests/support/eventually.h"

namespace rayloc::cluster::full_store_test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{30};
constexpr std::uint64_t kMemory = 1'000'000;   // bytes of the server
constexpr std::uint64_t kFiles = 100'000'000;  // bytes

class FullStore : public ::testing::Test {
 protected:
  FullStore() : folder_(::testing::TempDir() + "/full_store_test." + std::to_string(::getpid())) {
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<NatsServer>(folder_);
    server_->limit_store(kMemory, kFiles);
  }
  void TearDown() override {
    server_->kill();
    std::filesystem::remove_all(folder_);
  }
  std::shared_ptr<Broker> connect() {
    auto broker = open_broker({{server_->url()}, "test"});
    EXPECT_TRUE(broker) << broker.error().message;
    EXPECT_TRUE(eventually(kPatience, [&] { return (*broker)->connected(); }));
    return *broker;
  }
  // Stores messages of another stream until the server takes none.
  static bool fill_memory(Broker& broker) {
    StreamOptions filler;
    filler.name = filler.subjects = "filler";
    filler.max_age = std::chrono::seconds(0);
    EXPECT_TRUE(broker.ensure_stream(filler));
    const std::string block(100'000, 'x');
    std::uint64_t last = 0;
    return eventually(kPatience, [&] {
      const auto stored = broker.publish_behind(filler.subjects, block, last);
      last = stored && stored->is_last ? stored->sequence : last;
      const auto store = store_of(broker);
      return store && store->memory > kMemory;
    });
  }

  std::filesystem::path folder_;
  std::unique_ptr<NatsServer> server_;
};

// Batches and marks that a site's stream republishes.
class StoredBatches {
 public:
  Broker::Handler handler() {
    return [this](BrokerMessage&& message) {
      const Expected<Batch> batch = decode_batch(message.data);
      const std::lock_guard lock(mutex_);
      repeated_ += !batch || !numbers_.insert(batch->number).second ? 1U : 0U;
      for (const auto& [access_point, count] : batch ? counts_of(*batch) : NumberedRing::Counts()) {
        live_ += count;
      }
      for (const BatchGap& gap : batch ? batch->gaps : std::vector<BatchGap>()) {
        for (const auto& [access_point, count] : gap.datagrams) {
          marked_ += count;
        }
      }
    };
  }
  std::uint64_t live() const { return of(live_); }
  std::uint64_t marked() const { return of(marked_); }
  std::uint64_t repeated() const { return of(repeated_); }

 private:
  std::uint64_t of(const std::uint64_t& counter) const {
    const std::lock_guard lock(mutex_);
    return counter;
  }
  mutable std::mutex mutex_;
  std::set<std::uint64_t> numbers_;  // guarded by mutex_, as all
  std::uint64_t live_ = 0;
  std::uint64_t marked_ = 0;
  std::uint64_t repeated_ = 0;
};

// A capture node with one access point, whose datagrams come every few milliseconds.
class Node {
 public:
  explicit Node(const std::shared_ptr<Broker>& broker) {
    BatchSender::Options options;
    options.stream.max_age = std::chrono::seconds(0);
    options.limits.window_bytes = 20'000;
    options.limits.stale = milliseconds(300);
    options.limits.patience = milliseconds(200);
    role_ = *CaptureRole::open(broker, {"node1", kSomeEpoch, options});
    sender_ = *role_->add_site("office");
    tap_ = &sender_->tap("ap1");
    EXPECT_TRUE(sender_->start());
  }
  BatchSender& sender() { return *sender_; }
  std::uint64_t received() const { return received_; }
  bool receive_until(const std::function<bool(NumberedRing::Counters&)>& condition) {
    return eventually(kPatience, [&] {
      const Batch some = some_batch(++rounds_, {{"ap1", kDatagrams}});
      tap_->tap(some.parts[0].datagrams.datagrams());
      tap_->advance(some.parts[0].watermark);
      received_ += kDatagrams;
      BatchSender::Counters counters = sender_->counters();
      NumberedRing::Counters& ring = counters.ring;
      EXPECT_EQ(counters.captured["ap1"],
                ring.live["ap1"] + ring.marked["ap1"] + ring.waiting["ap1"]);
      return condition(ring);
    });
  }

 private:
  static constexpr std::size_t kDatagrams = 20;
  std::unique_ptr<CaptureRole> role_;
  std::shared_ptr<BatchSender> sender_;
  DatagramTap* tap_ = nullptr;
  std::uint64_t rounds_ = 0;
  std::uint64_t received_ = 0;
};

// `words`: of the server, for its refusal. `fill` and `empty`: the store.
void expect_marks_and_return(const std::shared_ptr<Broker>& broker,
                             const std::string& words,
                             const std::function<bool()>& fill,
                             const std::function<bool()>& empty) {
  StoredBatches stored;
  const auto subscription = broker->subscribe(live_subjects("office"), stored.handler());
  ASSERT_TRUE(subscription);
  Node node(broker);
  ASSERT_TRUE(node.receive_until([](auto& ring) { return ring.live["ap1"] > 100; }));
  EXPECT_EQ(node.sender().trouble(), "");
  ASSERT_TRUE(fill());
  std::string trouble;
  ASSERT_TRUE(node.receive_until([&](auto& ring) {
    trouble = trouble.empty() ? node.sender().trouble() : trouble;
    return ring.marked_batches > 5 && !trouble.empty();
  }));
  EXPECT_THAT(trouble, HasSubstr(words));
  EXPECT_THAT(trouble, HasSubstr(csi_subject("office", "node1")));
  EXPECT_GT(node.sender().counters().refused, 0U);
  const std::uint64_t live = node.sender().counters().ring.live["ap1"];
  ASSERT_TRUE(empty());
  ASSERT_TRUE(node.receive_until([&](auto& ring) { return ring.live["ap1"] > live + 300; }));
  ASSERT_TRUE(
      eventually(kPatience, [&] { return node.sender().counters().ring.waiting["ap1"] == 0; }));
  EXPECT_TRUE(eventually(kPatience, [&] { return node.sender().trouble().empty(); }));
  EXPECT_TRUE(
      eventually(kPatience, [&] { return stored.live() + stored.marked() == node.received(); }))
      << stored.live() << " and " << stored.marked() << " of " << node.received();
  BatchSender::Counters counters = node.sender().counters();
  EXPECT_EQ(counters.captured["ap1"], node.received());
  EXPECT_EQ(counters.ring.live["ap1"], stored.live());
  EXPECT_EQ(counters.ring.marked["ap1"], stored.marked());
  EXPECT_EQ(stored.repeated(), 0U);
  node.sender().finish();
}

TEST_F(FullStore, OfAServerCausesMarksAndLiveBatchesOnceItHasSpace) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  expect_marks_and_return(
      broker,
      "insufficient resources",
      [&] { return fill_memory(*broker); },
      [&] { return forget_stream(*broker, "filler").has_value(); });
}

// An operator may have created the stream, with a size beyond which it refuses messages.
TEST_F(FullStore, OfAStreamCausesMarksAndLiveBatchesOnceItHasSpace) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  const auto made = broker->ask(
      "$JS.API.STREAM.CREATE." + csi_stream("office"),
      fmt::format(R"({{"name": "{}", "subjects": ["{}"], "storage": "memory", "num_replicas": 1,
                       "retention": "limits", "discard": "new", "max_bytes": 100000,
                       "allow_direct": true, "republish": {{"src": "{}", "dest": "{}"}}}})",
                  csi_stream("office"),
                  csi_subjects("office"),
                  csi_subjects("office"),
                  live_subjects("office")));
  ASSERT_TRUE(made && made->find("\"error\"") == std::string::npos) << made.value_or("");
  expect_marks_and_return(
      broker,
      "maximum bytes exceeded",
      [] { return true; },  // its own batches fill it
      [&] {
        return forget_subjects(*broker, csi_stream("office"), csi_subjects("office")).has_value();
      });
}

class PublishedTimes final : public LocationSink {
 public:
  void location(Location&& location) override {
    const std::lock_guard lock(mutex_);
    times_.push_back(location.estimate.time);
  }
  std::vector<Timestamp> times() const {
    const std::lock_guard lock(mutex_);
    return times_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Timestamp> times_;  // guarded by mutex_
};

Timestamp instant(int ms) { return Timestamp(std::chrono::hours(500'000)) + milliseconds(ms); }

Location located_at(int ms) {
  Location location;
  location.target.address = "a";
  location.estimate.time = instant(ms);
  location.context.site = "office";
  return location;
}

std::unique_ptr<OwnerLog> begin_log(const std::shared_ptr<Broker>& broker,
                                    std::uint64_t generation) {
  OwnerLog::Options options;
  options.site = "office";
  options.generation = generation;
  options.worker = "w1";
  options.stream = output_stream({});
  auto log = OwnerLog::begin(broker, std::move(options));
  EXPECT_TRUE(log) << log.error().message;
  return log ? std::move(*log) : nullptr;
}

OutStage::Options quick_options() {
  OutStage::Options options;
  options.every = milliseconds(1);
  options.resume = [](Timestamp) { return SiteResume{}; };
  options.most_waiting = 5;
  return options;
}

// It retries for as long as few results wait; beyond that the site is given up, and the next
// owner continues behind the last stored record.
TEST_F(FullStore, DelaysTheResultsOfAnOwnerAndRepeatsNone) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  PublishedTimes published;
  OutStage first(begin_log(broker, 1), published, quick_options());
  first.start();
  const auto stores = [&](OutStage& stage, std::uint64_t items) {
    return eventually(kPatience, [&] { return stage.counters().items == items; });
  };
  const auto tries = [&](OutStage& stage) {
    const std::uint64_t beats = stage.progress().beats();
    return eventually(kPatience, [&] { return stage.progress().beats() >= beats + 4; });
  };
  first.location(located_at(10));
  first.advance(instant(20));
  ASSERT_TRUE(stores(first, 1));
  ASSERT_TRUE(fill_memory(*broker));
  first.location(located_at(30));
  first.advance(instant(40));
  ASSERT_TRUE(tries(first));
  EXPECT_EQ(first.counters().items, 1U);
  EXPECT_EQ(first.ended(), "");
  ASSERT_TRUE(forget_stream(*broker, "filler"));
  ASSERT_TRUE(stores(first, 2));

  ASSERT_TRUE(fill_memory(*broker));
  int ms = 50;
  ASSERT_TRUE(eventually(kPatience, [&] {
    first.location(located_at(ms));
    first.advance(instant(++ms));
    return !first.ended().empty();
  }));
  EXPECT_EQ(first.ended(), "the broker takes no results");
  ASSERT_TRUE(forget_stream(*broker, "filler"));
  first.finish();
  auto log = begin_log(broker, 2);
  EXPECT_EQ(log->start().from, instant(40));
  OutStage second(std::move(log), published, quick_options());
  second.start();
  second.location(located_at(50));
  second.location(located_at(60));
  second.advance(instant(65));
  ASSERT_TRUE(stores(second, 2));
  second.finish();
  EXPECT_EQ(published.times(),
            (std::vector<Timestamp>{instant(10), instant(30), instant(50), instant(60)}));
}

}  // namespace
}  // namespace rayloc::cluster::full_store_test
