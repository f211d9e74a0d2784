// Sites that share the threads of a process: their number depends on no number of sites, and none
// of the sites keeps the others from their turns. Fairness is stated in turns, not in time.
#include "daemon/pipeline/shared/shared_threads.h"

#include <sys/eventfd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <latch>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/source/udp_source.h"
#include "capture/transport/file_descriptor.h"
#include "capture/transport/udp_sender.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/shared/fair_queue.h"
#include "tests/support/eventually.h"

namespace rayloc::shared_threads_test {
namespace {

using Turn = WorkerPool::Turn;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Le;

constexpr std::chrono::seconds kPatience{60};
constexpr Duration kShort = std::chrono::milliseconds(1);
constexpr Duration kLong = std::chrono::milliseconds(100);

TEST(FairQueue, ServesTheMemberThatHasUsedLeast) {
  FairQueue queue;
  FairQueue::Share heavy;
  FairQueue::Share light;
  std::string order;
  queue.push(heavy);
  queue.push(light);
  for (int i = 0; i < 8; ++i) {
    FairQueue::Share* const next = queue.pop();
    ASSERT_NE(next, nullptr);
    order += next == &heavy ? 'H' : 'l';
    next->used += next == &heavy ? 3 * kShort : kShort;
    queue.push(*next);
  }
  EXPECT_EQ(order, "HlllHlll");
}

TEST(FairQueue, GivesNoCreditForRest) {
  FairQueue queue;
  FairQueue::Share busy;
  FairQueue::Share late;
  for (int i = 0; i < 100; ++i) {
    queue.push(busy);
    ASSERT_EQ(queue.pop(), &busy);
    busy.used += kShort;
  }
  std::string order;
  queue.push(busy);
  queue.push(late);
  for (int i = 0; i < 4; ++i) {
    FairQueue::Share* const next = queue.pop();
    order += next == &busy ? 'b' : 'l';
    next->used += kShort;
    queue.push(*next);
  }
  EXPECT_EQ(order, "lblb");
}

// The turns that members of a pool of one thread have taken, in order.
class TurnLog {
 public:
  explicit TurnLog(std::size_t members) : all_there_(static_cast<std::ptrdiff_t>(members)) {}
  // A member that takes `turns` of `cost` each.
  std::unique_ptr<WorkerPool::Member> add(WorkerPool& pool, char name, int turns, Duration cost) {
    auto member = pool.add([this, name, turns, cost, taken = 0]() mutable {
      all_there_.wait();  // with the first turn
      log_ += name;
      now_ += cost.count();
      return ++taken < turns ? Turn::kMore : Turn::kEnded;
    });
    all_there_.count_down();
    return member;
  }
  Duration now() const { return Duration(now_.load()); }
  const std::string& log() const { return log_; }

 private:
  std::latch all_there_;
  std::atomic<Duration::rep> now_{0};
  std::string log_;  // of the only thread
};

// The numbers of turns of `name` between two of `other`, after the first of `other`.
std::vector<int> turns_between(const std::string& log, char name, char other) {
  std::vector<int> counts;
  int count = 0;
  for (std::size_t i = std::min(log.find(other), log.size()); i < log.size(); ++i) {
    if (log[i] == other) {
      counts.push_back(count);
      count = 0;
    }
    count += log[i] == name ? 1 : 0;
  }
  return counts;
}

// A flooded site always has more work, and each of its turns takes a hundred times longer.
TEST(WorkerPool, AFloodedMemberTakesNoTurnFromItsNeighbors) {
  const std::string neighbors = "abcde";
  TurnLog log(1 + neighbors.size());
  WorkerPool pool(1, [&] { return log.now(); });
  std::vector<std::unique_ptr<WorkerPool::Member>> members;
  members.push_back(log.add(pool, 'F', 50, kLong));
  for (const char name : neighbors) {
    members.push_back(log.add(pool, name, 90, kShort));
  }
  for (const auto& member : members) {
    member->wait_for_end();
  }
  const std::string& turns = log.log();
  for (const char name : neighbors) {
    EXPECT_EQ(std::count(turns.begin(), turns.end(), name), 90);
    EXPECT_THAT(turns_between(turns, 'F', name), Each(Le(1)));
    for (const char other : neighbors) {
      EXPECT_THAT(turns_between(turns, other, name), Each(Le(2)));
    }
  }
  // All turns of the neighbors take less time than one of the flood.
  const std::size_t last = turns.find_last_of(neighbors);
  EXPECT_LE(std::count(turns.begin(), turns.begin() + static_cast<std::ptrdiff_t>(last), 'F'), 2);
}

TEST(WorkerPool, AMemberThatIsWokenDuringItsTurnTakesAnother) {
  std::latch runs(1);
  std::latch woken(1);
  int turns = 0;
  WorkerPool pool(2);
  const auto member = pool.add([&] {
    if (++turns == 1) {
      runs.count_down();
      woken.wait();
      return Turn::kWaits;
    }
    return Turn::kEnded;
  });
  runs.wait();
  member->wake();
  woken.count_down();
  member->wait_for_end();
  EXPECT_EQ(turns, 2);
  EXPECT_EQ(pool.threads(), 1U);
}

TEST(WorkerPool, HasNoMoreThreadsThanItsMembersNeed) {
  WorkerPool pool(3);
  EXPECT_EQ(pool.threads(), 0U);
  for (int round = 0; round < 4; ++round) {
    const auto member = pool.add([] { return Turn::kEnded; });
    member->wait_for_end();
  }
  EXPECT_EQ(pool.threads(), 1U);
  std::latch all(3);
  std::vector<std::unique_ptr<WorkerPool::Member>> members;
  members.reserve(3);
  for (int i = 0; i < 3; ++i) {
    members.push_back(pool.add([&] {
      all.arrive_and_wait();
      return Turn::kEnded;
    }));
  }
  for (const auto& member : members) {
    member->wait_for_end();
  }
  EXPECT_EQ(pool.threads(), 3U);
}

// Always has more input, for so many steps, the first of which waits for all readers.
class Flood final : public PolledReader {
 public:
  Flood(std::latch& all_there, std::string& log, char name, int steps)
      : all_there_(all_there), log_(log), name_(name), rest_(steps) {}
  int descriptor() const override { return -1; }
  bool read_once() override {
    all_there_.wait();
    log_ += name_;
    return --rest_ > 0;
  }
  bool may_have_more() const override { return true; }

 private:
  std::latch& all_there_;
  std::string& log_;
  const char name_;
  int rest_;
};

// Has input when its event is set. Ends after so many events.
class EventReader final : public PolledReader {
 public:
  explicit EventReader(int events) : events_(events) {}
  int descriptor() const override { return event_.get(); }
  bool read_once() override {
    eventfd_t value = 0;
    read_ += ::eventfd_read(event_.get(), &value) == 0 ? 1 : 0;
    return read_ < events_;
  }
  bool may_have_more() const override { return false; }
  void set() const { ASSERT_EQ(::eventfd_write(event_.get(), 1), 0); }
  int read() const { return read_; }

 private:
  const FileDescriptor event_{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  const int events_;
  std::atomic<int> read_{0};
};

TEST(ReceiverPool, AFloodedReaderTakesOneStepInEachRound) {
  ReceiverPool pool({.most_threads = 1});
  std::latch all_there(1);
  std::string log;  // of the only thread
  Flood flood(all_there, log, 'F', 2000);
  Flood neighbor(all_there, log, 'a', 500);
  Flood other(all_there, log, 'b', 500);
  pool.add(flood);
  pool.add(neighbor);
  pool.add(other);
  all_there.count_down();
  for (Flood* const reader : {&flood, &neighbor, &other}) {
    pool.wait_for_end(*reader);
  }
  EXPECT_EQ(pool.threads(), 1U);
  EXPECT_EQ(log.size(), 3000U);
  EXPECT_THAT(turns_between(log, 'F', 'a'), Each(Le(1)));
  EXPECT_THAT(turns_between(log, 'F', 'b'), Each(Le(1)));
}

TEST(ReceiverPool, ReadsWhatComesAndStartsNoMoreThreadsThanItMay) {
  constexpr int kEvents = 20;
  ReceiverPool pool({.most_threads = 2});
  std::vector<std::unique_ptr<EventReader>> readers;
  for (int i = 0; i < 5; ++i) {
    readers.push_back(std::make_unique<EventReader>(kEvents));
    pool.add(*readers.back());
  }
  for (int event = 1; event <= kEvents; ++event) {
    for (const auto& reader : readers) {
      reader->set();
    }
    for (const auto& reader : readers) {
      ASSERT_TRUE(eventually(kPatience, [&] { return reader->read() == event; }));
    }
  }
  for (const auto& reader : readers) {
    pool.wait_for_end(*reader);
  }
  EXPECT_EQ(pool.threads(), 2U);
}

// Is asked to end while its thread waits for the next tick, an hour away.
class EndingReader final : public PolledReader {
 public:
  int descriptor() const override { return -1; }
  bool read_once() override {
    ++steps_;
    return !is_ending_;
  }
  bool may_have_more() const override { return false; }
  void end() { is_ending_ = true; }
  int steps() const { return steps_; }

 private:
  std::atomic<bool> is_ending_{false};
  std::atomic<int> steps_{0};
};

TEST(ReceiverPool, AReaderThatIsToEndWaitsForNoTick) {
  ReceiverPool pool({.most_threads = 1, .tick = std::chrono::hours(1)});
  EndingReader reader;
  pool.add(reader);
  const bool has_begun = eventually(kPatience, [&] { return reader.steps() == 1; });
  reader.end();
  pool.wait_for_end(reader);
  EXPECT_TRUE(has_begun);
  EXPECT_EQ(reader.steps(), 2);
}

// Does not return before it may, like a disk that does not answer.
class StuckTap final : public DatagramTap {
 public:
  explicit StuckTap(std::latch& may_return) : may_return_(may_return) {}
  void tap(std::span<const Datagram> datagrams) override {
    if (!datagrams.empty()) {
      is_stuck_ = true;
      may_return_.wait();
    }
  }
  bool is_stuck() const { return is_stuck_; }

 private:
  std::latch& may_return_;
  std::atomic<bool> is_stuck_{false};
};

class NoEstimator : public Estimator {
 public:
  void estimate(const Burst& /*burst*/, Estimates& /*out*/) override {}
};

class NoSink : public LocationSink {
 public:
  void location(Location&& /*location*/) override {}
};

// A site with one access point at a port of loopback.
class LoneSite {
 public:
  explicit LoneSite(std::shared_ptr<SharedThreads> threads, DatagramTap* tap = nullptr) {
    UdpSourceOptions udp;
    udp.address = "127.0.0.1:0";
    auto source = UdpSource::open(udp).value();
    sender_ = UdpSender::open("127.0.0.1:" + std::to_string(source->port())).value();
    std::vector<SourceWorker::Input> inputs(1);
    inputs[0].access_point = "ap1";
    inputs[0].source = std::move(source);
    if (tap != nullptr) {
      inputs[0].taps.push_back(tap);
    }
    PipelineOptions options;
    options.threads = std::move(threads);
    pipeline_ = std::make_unique<Pipeline>(options, std::move(inputs), estimator_, sink_);
    pipeline_->start();
  }
  void send() {
    const std::vector<std::byte> bytes(8);
    DatagramBatch batch;
    batch.datagrams.emplace_back().payload = bytes;
    ASSERT_TRUE(sender_->write(batch));
  }
  std::uint64_t received() const { return pipeline_->source_reports()[0].source.received; }
  bool has_begun() const {
    const std::vector<Stage> stages = pipeline_->stages();
    return std::all_of(
        stages.begin(), stages.end(), [](const Stage& stage) { return stage.progress->started(); });
  }
  // The watchdog does not judge a stage that rests.
  bool source_rests() const { return pipeline_->stages().front().progress->resting(); }
  std::vector<bool> shared_stages() const {
    std::vector<bool> shared;
    for (const Stage& stage : pipeline_->stages()) {
      shared.push_back(stage.has_shared_thread);
    }
    return shared;
  }
  bool stop() {
    pipeline_->stop();
    return pipeline_->finished();
  }

 private:
  NoEstimator estimator_;
  NoSink sink_;
  std::unique_ptr<UdpSender> sender_;
  std::unique_ptr<Pipeline> pipeline_;
};

std::size_t threads_of_process() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

// The threads that so many sites need, each of which gets its datagrams.
std::size_t threads_for(std::size_t sites) {
  constexpr std::uint64_t kEach = 10;
  const std::size_t before = threads_of_process();
  const auto threads = std::make_shared<SharedThreads>(2, 3);
  std::vector<std::unique_ptr<LoneSite>> all;
  for (std::size_t i = 0; i < sites; ++i) {
    all.push_back(std::make_unique<LoneSite>(threads));
  }
  for (std::uint64_t i = 0; i < kEach; ++i) {
    for (const auto& site : all) {
      site->send();
    }
  }
  for (const auto& site : all) {
    EXPECT_TRUE(
        eventually(kPatience, [&] { return site->received() == kEach && site->has_begun(); }));
  }
  const std::size_t during = threads_of_process();
  for (const auto& site : all) {
    EXPECT_TRUE(site->stop());
  }
  return during - before;
}

TEST(SharedThreads, AreNoMoreForTwentySitesThanTheirBound) {
  EXPECT_EQ(threads_for(1), 2U);  // a receiver and a worker
  EXPECT_EQ(threads_for(20), 5U);
}

// The watchdog goes on to check these when their site is abandoned.
TEST(SharedThreads, AreStatedByTheStagesOnThem) {
  LoneSite one(std::make_shared<SharedThreads>(1, 1));
  EXPECT_THAT(one.shared_stages(), ElementsAre(true, true));
  EXPECT_TRUE(one.stop());
  EXPECT_THAT(one.shared_stages(), ElementsAre(true, true));
  LoneSite alone(nullptr);
  EXPECT_THAT(alone.shared_stages(), ElementsAre(false, false));
  EXPECT_TRUE(alone.stop());
}

// A site that starts or ends leaves the threads of the others alone.
TEST(SharedThreads, ServeTheOtherSitesWhenOneEnds) {
  const auto threads = std::make_shared<SharedThreads>(1, 1);
  LoneSite stays(threads);
  for (std::uint64_t round = 1; round <= 3; ++round) {
    LoneSite leaves(threads);
    leaves.send();
    EXPECT_TRUE(eventually(kPatience, [&] { return leaves.received() == 1; }));
    EXPECT_TRUE(leaves.stop());
    stays.send();
    EXPECT_TRUE(eventually(kPatience, [&] { return stays.received() == round; }));
  }
}

// The watchdog names the site whose tap does not return, and not those that wait behind it.
TEST(SharedThreads, AStuckSourceIsTheOnlyOneThatDoesNotRest) {
  const auto threads = std::make_shared<SharedThreads>(1, 1);
  std::latch may_return(1);
  StuckTap tap(may_return);
  LoneSite stuck(threads, &tap);
  LoneSite other(threads);
  other.send();
  ASSERT_TRUE(eventually(kPatience, [&] { return other.received() == 1; }));
  stuck.send();
  ASSERT_TRUE(eventually(kPatience, [&] { return tap.is_stuck(); }));
  EXPECT_FALSE(stuck.source_rests());
  EXPECT_TRUE(other.source_rests());
  may_return.count_down();
  EXPECT_TRUE(stuck.stop());
  EXPECT_TRUE(other.stop());
}

}  // namespace
}  // namespace rayloc::shared_threads_test
