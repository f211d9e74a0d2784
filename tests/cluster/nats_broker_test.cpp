// The broker against a real server: the operations that the rest of a cluster requires.
#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/batch_sender.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/history/fill_replay.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/live/cluster/sequencer.h"
#include "daemon/live/cluster/stream_reader.h"
#include "rayloc/v1/cluster.pb.h"
#include "tests/cluster/nats_server.h"
#include "tests/daemon/live/cluster/some_batch.h"
#include "tests/support/eventually.h"

namespace rayloc::cluster::nats_broker_test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{30};

class RealBroker : public ::testing::Test {
 protected:
  RealBroker() : folder_(::testing::TempDir() + "/broker_test." + std::to_string(::getpid())) {
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<NatsServer>(folder_);
  }
  ~RealBroker() override {
    server_->kill();
    std::filesystem::remove_all(folder_);
  }
  std::shared_ptr<Broker> connect() {
    auto broker = open_broker({{server_->url()}, "test"});
    EXPECT_TRUE(broker) << broker.error().message;
    return *broker;
  }
  static bool connected(Broker& broker) {
    return eventually(kPatience, [&] { return broker.connected(); });
  }

  std::filesystem::path folder_;
  std::unique_ptr<NatsServer> server_;
};

struct Inbox {
  std::mutex mutex;
  std::vector<BrokerMessage> messages;
  Broker::Handler handler() {
    return [this](BrokerMessage&& message) {
      const std::lock_guard lock(mutex);
      messages.push_back(std::move(message));
    };
  }
  std::size_t size() {
    const std::lock_guard lock(mutex);
    return messages.size();
  }
};

TEST_F(RealBroker, ConnectsWhenTheServerComesAndAgainAfterItWasAway) {
  RAYLOC_NEEDS_NATS_SERVER();
  const std::shared_ptr<Broker> broker = connect();
  EXPECT_FALSE(broker->connected());
  Inbox inbox;
  auto subscription = broker->subscribe("some.*", inbox.handler());
  ASSERT_TRUE(subscription);
  EXPECT_FALSE(broker->publish("some.word", "nobody is there"));
  ASSERT_TRUE(server_->start());
  ASSERT_TRUE(connected(*broker));
  EXPECT_EQ(broker->connections(), 1U);
  ASSERT_TRUE(broker->publish("some.word", "first"));
  ASSERT_TRUE(eventually(kPatience, [&] { return inbox.size() == 1; }));
  EXPECT_EQ(inbox.messages[0].subject, "some.word");
  EXPECT_EQ(inbox.messages[0].data, "first");
  server_->kill();
  ASSERT_TRUE(eventually(kPatience, [&] { return !broker->connected(); }));
  ASSERT_TRUE(server_->start());
  ASSERT_TRUE(connected(*broker));
  EXPECT_EQ(broker->connections(), 2U);
  EXPECT_TRUE(eventually(
      kPatience, [&] { return broker->publish("some.word", "second") && inbox.size() >= 2; }));
  subscription->reset();
  ASSERT_TRUE(broker->publish("some.word", "to nobody"));
}

// If the first answer of a server takes longer than a second, libnats gives up.
TEST_F(RealBroker, ConnectsToAServerThatHangsAtFirst) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  server_->freeze();
  const std::shared_ptr<Broker> broker = connect();
  Inbox inbox;
  auto subscription = broker->subscribe("some.*", inbox.handler());
  ASSERT_TRUE(subscription);
  ASSERT_TRUE(eventually(kPatience, [&] { return broker->failed_tries() >= 2; }));
  EXPECT_FALSE(broker->connected());
  EXPECT_NE(broker->refusal(), "");
  EXPECT_FALSE(broker->stream_state("any"));
  server_->thaw();
  ASSERT_TRUE(connected(*broker));
  EXPECT_EQ(broker->connections(), 1U);
  EXPECT_EQ(broker->refusal(), "");
  EXPECT_TRUE(eventually(
      kPatience, [&] { return broker->publish("some.word", "at last") && inbox.size() > 0; }));
}

// A server that refuses a client twice in succession: libnats closes the existing connection.
TEST_F(RealBroker, ConnectsAgainWhereItWasRefused) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  ASSERT_TRUE(connected(*broker));
  Inbox inbox;
  auto subscription = broker->subscribe("some.*", inbox.handler());
  ASSERT_TRUE(subscription);
  server_->kill();
  std::ofstream(folder_ / "closed.conf") << "authorization { user: x, password: y }\n";
  server_->set_configuration(folder_ / "closed.conf");
  ASSERT_TRUE(server_->start());
  ASSERT_TRUE(eventually(kPatience, [&] { return broker->failed_tries() >= 1; }))
      << broker->refusal();
  EXPECT_THAT(broker->refusal(), HasSubstr("uthorization"));
  server_->kill();
  server_->set_configuration({});
  ASSERT_TRUE(server_->start());
  ASSERT_TRUE(connected(*broker));
  EXPECT_TRUE(eventually(
      kPatience, [&] { return broker->publish("some.word", "let in") && inbox.size() > 0; }));
}

TEST_F(RealBroker, StreamsStoreOnceReplayAndAnswerBySequence) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  const StreamOptions stream = site_stream("lab 2", {});
  const auto made = broker->ensure_stream(stream);
  ASSERT_TRUE(made) << made.error().message;
  ASSERT_TRUE(broker->ensure_stream(stream));  // it exists already
  Inbox live;
  auto subscription = broker->subscribe(live_subjects("lab 2"), live.handler());
  ASSERT_TRUE(subscription);
  std::mutex mutex;
  std::vector<std::string> acknowledged;
  auto publisher = broker->acked_publisher([&](std::uint64_t token, const std::string& trouble) {
    const std::lock_guard lock(mutex);
    acknowledged.push_back(std::to_string(token) + trouble);
  });
  ASSERT_TRUE(publisher);
  const std::string subject = csi_subject("lab 2", "node.1");
  ASSERT_TRUE((*publisher)->publish(subject, "one", "id-1", 1));
  ASSERT_TRUE((*publisher)->publish(subject, "one", "id-1", 1));
  ASSERT_TRUE((*publisher)->publish(subject, "two", "id-2", 2));
  ASSERT_TRUE((*publisher)->publish("rayloc.v1.csi.nowhere.x", "three", "id-3", 3));
  ASSERT_TRUE(eventually(kPatience, [&] {
    const std::lock_guard lock(mutex);
    return acknowledged.size() == 4;
  }));
  EXPECT_THAT(acknowledged, ::testing::UnorderedElementsAre("1", "1", "2", "3no stream takes it"));
  ASSERT_TRUE(eventually(kPatience, [&] { return live.size() == 2; }));
  EXPECT_EQ(live.messages[1].sequence, 2U);
  EXPECT_EQ(live.messages[1].subject, subject);
  EXPECT_EQ(live.messages[1].data, "two");

  const auto second = broker->get(stream.name, 2);
  ASSERT_TRUE(second && *second) << (second ? "none" : second.error().message);
  EXPECT_EQ((*second)->sequence, 2U);
  EXPECT_EQ((*second)->subject, subject);
  EXPECT_EQ((*second)->data, "two");
  const auto third = broker->get(stream.name, 3);
  ASSERT_TRUE(third);
  EXPECT_FALSE(*third);
  const auto last = broker->last_of(stream.name, subject);
  ASSERT_TRUE(last && *last);
  EXPECT_EQ((*last)->sequence, 2U);
  const auto state = broker->stream_state(stream.name);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->first, 1U);
  EXPECT_EQ(state->last, 2U);
  EXPECT_GT(state->created.time_since_epoch().count(), 0);
  EXPECT_FALSE(broker->stream_state("no_such"));
  publisher->reset();
  subscription->reset();
}

TEST_F(RealBroker, PublishesOnlyBehindTheLastMessage) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> broker = connect();
  StreamOptions short_lived;
  short_lived.max_age = std::chrono::seconds(5);
  ASSERT_TRUE(broker->ensure_stream(output_stream(short_lived)));
  const std::string office = output_subject("office");
  const auto none = broker->last_of(std::string(kOutputStream), office);
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_FALSE(*none);
  const auto first = broker->publish_behind(office, "a", 0);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_TRUE(first->is_last);
  ASSERT_TRUE(broker->publish_behind(output_subject("lab"), "x", 0)->is_last);
  const auto second = broker->publish_behind(office, "b", first->sequence);
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->is_last);
  const auto late = broker->publish_behind(office, "c", first->sequence);
  ASSERT_TRUE(late);
  EXPECT_FALSE(late->is_last);
  EXPECT_FALSE(broker->publish_behind(office, "d", 0)->is_last);
}

// Datagrams of an access point, from a separate thread.
class TapWriter {
 public:
  TapWriter(DatagramTap& tap, milliseconds period) : tap_(tap), period_(period) {}
  void begin() {
    thread_ = std::thread([this] {
      while (!ending_) {
        const std::uint64_t round = ++rounds_;
        const Batch some = some_batch(round, {{"x", 1 + round % 3}});
        tap_.tap(some.parts[0].datagrams.datagrams());
        tap_.advance(some.parts[0].watermark);
        received_ += 1 + round % 3;
        std::this_thread::sleep_for(period_);
      }
    });
  }
  void end() {
    ending_ = true;
    thread_.join();
  }
  std::uint64_t received() const { return received_; }

 private:
  DatagramTap& tap_;
  const milliseconds period_;
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> received_{0};
  std::uint64_t rounds_ = 0;
  std::thread thread_;
};

// Reads the stream of a site from its beginning and requests missing batches.
class Reading {
 public:
  Reading(std::shared_ptr<Broker> broker, const std::string& site, std::string node)
      : broker_(std::move(broker)), site_(site), node_(std::move(node)) {
    StreamReader::Options options;
    options.stream = csi_stream(site);
    options.again = live_subjects(site);
    reader_ = *StreamReader::open(broker_, options);
    thread_ = std::thread([this] { run(); });
  }
  void end() {
    ending_ = true;
    thread_.join();
  }
  std::uint64_t all(const std::string& access_point) {
    return taken(access_point) + marked(access_point);
  }
  std::uint64_t taken(const std::string& access_point) {
    const std::lock_guard lock(mutex_);
    return taken_[access_point];
  }
  std::uint64_t marked(const std::string& access_point) {
    const std::lock_guard lock(mutex_);
    return counters_.marked_datagrams[access_point];
  }
  Sequencer::Counters counters() {
    const std::lock_guard lock(mutex_);
    return counters_;
  }
  bool in_order() const { return in_order_; }

 private:
  void run() {
    Sequencer sequencer({}, true);
    while (!ending_) {
      std::vector<Sequencer::Taken> out;
      if (const auto message = reader_->next(milliseconds(100))) {
        sequencer.push(node_, *decode_batch(message->data), out);
      }
      for (const Sequencer::Hole& hole : sequencer.holes()) {
        v1::ResendRequest request;
        request.set_site(site_);
        request.set_epoch(hole.epoch);
        request.set_from_number(hole.from);
        request.set_to_number(hole.to);
        (void)broker_->publish(resend_subject(node_), seal(request));
      }
      note(out, sequencer.counters());
    }
  }
  void note(const std::vector<Sequencer::Taken>& out, Sequencer::Counters counters) {
    const std::lock_guard lock(mutex_);
    counters_ = std::move(counters);
    for (const Sequencer::Taken& one : out) {
      in_order_ = in_order_ && one.batch.number > last_;
      last_ = one.batch.number;
      for (const BatchPart& part : one.batch.parts) {
        taken_[part.access_point] += part.datagrams.entries.size();
      }
    }
  }

  std::shared_ptr<Broker> broker_;
  const std::string site_;
  const std::string node_;
  std::unique_ptr<StreamReader> reader_;
  std::atomic<bool> ending_{false};
  std::atomic<bool> in_order_{true};
  std::uint64_t last_ = 0;
  std::mutex mutex_;
  std::map<std::string, std::uint64_t> taken_;  // guarded by mutex_
  Sequencer::Counters counters_;                // guarded by mutex_
  std::thread thread_;
};

// Batches through a server that is killed, loses its memory store, and hangs.
TEST_F(RealBroker, EveryDatagramIsInABatchOrInAMark) {
  RAYLOC_NEEDS_NATS_SERVER();
  const std::shared_ptr<Broker> broker = connect();  // the server does not run yet
  auto role = CaptureRole::open(broker, {"node1", kSomeEpoch, {}});
  ASSERT_TRUE(role);
  const std::shared_ptr<BatchSender> sender = *(*role)->add_site("office");
  DatagramTap& tap = sender->tap("ap1");
  ASSERT_TRUE(sender->start());
  std::uint64_t round = 0;
  const auto receive = [&] {
    const Batch some = some_batch(++round, {{"ap1", 10}});
    tap.tap(some.parts[0].datagrams.datagrams());
    tap.advance(some.parts[0].watermark);
    std::this_thread::sleep_for(milliseconds(10));  // the pace of datagrams
  };
  const auto receive_until = [&](const auto& condition) {
    return eventually(kPatience, [&] {
      receive();
      return condition(sender->counters().ring);
    });
  };
  const auto receive_some = [&](int rounds) {
    for (int i = 0; i < rounds; ++i) {
      receive();
    }
  };
  EXPECT_TRUE(receive_until([](const auto& ring) { return ring.marked_batches > 0; }))
      << "it waits for a broker for ever";
  ASSERT_TRUE(server_->start());
  ASSERT_TRUE(connected(*broker));
  ASSERT_TRUE(receive_until([](auto ring) { return ring.live["ap1"] > 0; }));
  server_->freeze();
  receive_some(50);
  server_->thaw();
  const std::uint64_t live = sender->counters().ring.live["ap1"];
  ASSERT_TRUE(receive_until([&](auto ring) { return ring.live["ap1"] > live; }));
  server_->kill();
  receive_some(30);
  ASSERT_TRUE(server_->start());
  ASSERT_TRUE(connected(*broker));
  receive_some(30);
  ASSERT_TRUE(eventually(kPatience, [&] { return sender->counters().ring.waiting["ap1"] == 0; }));
  BatchSender::Counters counters = sender->counters();
  EXPECT_EQ(counters.captured["ap1"], 10 * round);
  EXPECT_EQ(counters.captured["ap1"], counters.ring.live["ap1"] + counters.ring.marked["ap1"]);
  EXPECT_EQ(sender->trouble(), "");
  // Batches behind gap marks are filled in once the history stream exists.
  ASSERT_TRUE(broker->ensure_stream(fill_stream({})));
  EXPECT_TRUE(
      eventually(kPatience, [&] { return sender->counters().filled == counters.ring.marked; }));
  EXPECT_EQ(sender->counters().to_fill["ap1"], 0U);
  sender->finish();
  StreamReplay replay;
  replay.site = "office";
  replay.access_points = {"ap1"};
  std::set<Timestamp> times;
  replay.run = [&](const SiteStart&,
                   std::vector<std::unique_ptr<DatagramSource>> sources,
                   LocationSink&) -> Expected<void> {
    for (DatagramBatch batch; !batch.ended;) {
      EXPECT_TRUE(sources[0]->read(batch, Duration(0)));
      for (const Datagram& datagram : batch.datagrams) {
        EXPECT_TRUE(times.empty() || datagram.time > *times.rbegin());
        times.insert(datagram.time);
      }
    }
    return {};
  };
  const auto history = replay_fill(*broker, replay);
  ASSERT_TRUE(history) << history.error().message;
  EXPECT_EQ(history->datagrams, counters.ring.marked["ap1"]);
  EXPECT_EQ(times.size(), history->datagrams);
}

// A reader that starts late, of a stream whose server is killed and hangs.
TEST_F(RealBroker, EveryDatagramThatIsCapturedIsReadOnceOrMarked) {
  RAYLOC_NEEDS_NATS_SERVER();
  ASSERT_TRUE(server_->start());
  const std::shared_ptr<Broker> of_node = connect();
  BatchSender::Options options;
  options.stream.in_memory = false;
  auto role = CaptureRole::open(of_node, {"node1", kSomeEpoch, options});
  ASSERT_TRUE(role);
  const std::shared_ptr<BatchSender> sender = *(*role)->add_site("office");
  TapWriter first(sender->tap("ap1"), milliseconds(3));
  TapWriter second(sender->tap("ap2"), milliseconds(7));
  ASSERT_TRUE(sender->start());
  first.begin();
  second.begin();
  ASSERT_TRUE(eventually(kPatience, [&] { return sender->counters().ring.live["ap1"] > 100; }));
  Reading reading(connect(), "office", "node1");
  // The reader passes all datagrams received so far.
  const auto is_read_on = [&] {
    const std::uint64_t received = first.received();
    return eventually(kPatience, [&] { return reading.all("ap1") > received; });
  };
  ASSERT_TRUE(is_read_on());
  server_->freeze();
  ASSERT_TRUE(eventually(kPatience, [&, received = first.received()] {
    return first.received() > received + 200;  // none of them is stored meanwhile
  }));
  server_->thaw();
  ASSERT_TRUE(is_read_on());
  server_->kill();
  ASSERT_TRUE(eventually(kPatience, [&] { return sender->counters().ring.marked_batches > 5; }));
  ASSERT_TRUE(server_->start());
  ASSERT_TRUE(connected(*of_node));
  ASSERT_TRUE(is_read_on());
  first.end();
  second.end();
  ASSERT_TRUE(eventually(kPatience,
                         [&] {
                           return reading.all("ap1") == first.received() &&
                                  reading.all("ap2") == second.received();
                         }))
      << reading.all("ap1") << " of " << first.received() << ", " << reading.all("ap2") << " of "
      << second.received();
  reading.end();
  sender->finish();
  EXPECT_GT(reading.marked("ap1"), 0U);
  EXPECT_EQ(reading.counters().missing, 0U);
  EXPECT_TRUE(reading.in_order());
}

}  // namespace
}  // namespace rayloc::cluster::nats_broker_test
