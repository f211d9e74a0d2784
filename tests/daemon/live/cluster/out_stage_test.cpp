#include "daemon/live/cluster/ownership/out_stage.h"

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "daemon/live/cluster/sealed_message.h"
#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/support/eventually.h"

namespace rayloc::out_stage_test {
namespace {

using std::chrono::milliseconds;

constexpr std::chrono::seconds kPatience{20};

Timestamp at(int ms) { return Timestamp(std::chrono::hours(500'000)) + milliseconds(ms); }

std::unique_ptr<OwnerLog> begun(const std::shared_ptr<FakeBroker>& broker,
                                std::uint64_t generation) {
  OwnerLog::Options options;
  options.site = "hall";
  options.generation = generation;
  options.worker = "w" + std::to_string(generation);
  options.stream = output_stream({});
  auto log = OwnerLog::begin(broker, std::move(options));
  return log ? std::move(*log) : nullptr;
}

Location located(int ms, const std::string& device) {
  Location location;
  location.target.address = device;
  location.estimate.time = at(ms);
  location.context.site = "hall";
  return location;
}

// Collects the locations that this machine publishes.
class CollectingSink : public LocationSink {
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

std::vector<v1::OutputRecord> records(const FakeBroker& broker) {
  std::vector<v1::OutputRecord> all;
  for (const BrokerMessage& message : broker.stored()) {
    v1::OutputRecord& record = all.emplace_back();
    EXPECT_TRUE(unseal(message.data, record));
  }
  return all;
}

TEST(OwnerLog, AReplacedOwnerPublishesNothingMore) {
  const auto broker = std::make_shared<FakeBroker>();
  const auto first = begun(broker, 1);
  v1::SiteOutput output;
  output.set_done_us(us_of(at(5)));
  ASSERT_EQ(first->append(output), OwnerLog::Outcome::kStored);
  const auto second = begun(broker, 2);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->start().from, at(5));
  const std::size_t before = broker->stored().size();
  EXPECT_EQ(first->append(output), OwnerLog::Outcome::kReplaced);
  EXPECT_EQ(begun(broker, 2), nullptr);
  EXPECT_EQ(begun(broker, 1), nullptr);
  EXPECT_EQ(broker->stored().size(), before);
  EXPECT_EQ(second->append(output), OwnerLog::Outcome::kStored);
}

TEST(OwnerLog, ContinuesBehindRecordsThatAreNotOfAnOwner) {
  const auto broker = std::make_shared<FakeBroker>();
  const auto owner = begun(broker, 2);
  ASSERT_TRUE(broker->publish(output_subject("hall"), "no record at all"));
  v1::OutputRecord old;
  old.set_generation(1);
  ASSERT_TRUE(broker->publish(output_subject("hall"), seal(old)));
  EXPECT_EQ(owner->append({}), OwnerLog::Outcome::kNotYet);
  EXPECT_EQ(owner->append({}), OwnerLog::Outcome::kStored);
}

TEST(OwnerLog, RestartsIfTheStreamWasLost) {
  const auto broker = std::make_shared<FakeBroker>();
  const auto owner = begun(broker, 3);
  broker->forget_streams();
  EXPECT_EQ(owner->append({}), OwnerLog::Outcome::kNotYet);
  EXPECT_EQ(owner->append({}), OwnerLog::Outcome::kStored);
}

// The owner slept for longer than results are kept, and its successor has ended meanwhile.
TEST(OwnerLog, AnOwnerSuspendedBeyondRetentionPublishesNothingMore) {
  const auto broker = std::make_shared<FakeBroker>();
  const auto asleep = begun(broker, 3);
  ASSERT_TRUE(broker->ensure_stream(claim_stream({})));
  v1::SiteClaim claim;
  claim.set_worker("w3");
  claim.set_generation(3);
  ASSERT_TRUE(broker->publish_behind(claim_subject("hall"), seal(claim), 0));
  broker->drop(std::string(kOutputStream), 1);
  EXPECT_EQ(asleep->append({}), OwnerLog::Outcome::kNotYet);
  EXPECT_EQ(asleep->append({}), OwnerLog::Outcome::kStored);
  claim.set_worker("w4");
  claim.set_generation(4);
  ASSERT_TRUE(broker->publish_behind(claim_subject("hall"), seal(claim), 1));
  broker->drop(std::string(kOutputStream), 2);
  EXPECT_EQ(asleep->append({}), OwnerLog::Outcome::kReplaced);
}

OutStage::Options quick() {
  OutStage::Options options;
  options.every = milliseconds(1);
  options.at_most = milliseconds(10);
  options.resume = [](Timestamp) {
    SiteResume resume;
    resume.place.sequence = 7;
    resume.nodes["node1"] = {11, 12, {}};
    return resume;
  };
  return options;
}

TEST(OutStage, TwoOwnersPublishEachInstantOnceAndInOrder) {
  const auto broker = std::make_shared<FakeBroker>();
  CollectingSink received;
  OutStage first(begun(broker, 1), received, quick());
  first.start();
  first.location(located(20, "b"));
  first.location(located(10, "a"));
  first.location(located(40, "a"));
  first.advance(at(30));
  ASSERT_TRUE(eventually(kPatience, [&] { return first.counters().items == 2; }));
  // The first sleeps; the second publishes the results that the first had not published.
  auto log = begun(broker, 2);
  EXPECT_EQ(log->start().from, at(30));
  EXPECT_EQ(log->start().resume.place.sequence, 7U);
  EXPECT_EQ(log->start().resume.nodes.at("node1").number, 12U);
  OutStage second(std::move(log), received, quick());
  second.start();
  second.location(located(40, "a"));
  second.advance(at(50));
  first.advance(at(50));
  ASSERT_TRUE(eventually(kPatience, [&] { return !first.ended().empty(); }));
  EXPECT_EQ(first.ended(), "another worker has it");
  second.finish();
  std::vector<std::int64_t> published;
  for (const v1::OutputRecord& record : records(*broker)) {
    for (const v1::OutputItem& item : record.output().items()) {
      published.push_back(item.location().time().nanos() / 1'000'000);
    }
  }
  EXPECT_EQ(published, (std::vector<std::int64_t>{10, 20, 40}));
  EXPECT_EQ(received.times(), (std::vector<Timestamp>{at(10), at(20), at(40)}));
  EXPECT_TRUE(records(*broker).back().output().released());
}

TEST(OutStage, DeliversOnlyResultsThatTheBrokerStored) {
  const auto broker = std::make_shared<FakeBroker>();
  CollectingSink received;
  OutStage stage(begun(broker, 1), received, quick());
  stage.start();
  broker->set_connected(false);
  stage.location(located(10, "a"));
  stage.advance(at(20));
  // It tries again and again.
  ASSERT_TRUE(eventually(kPatience, [&, before = stage.progress().beats()] {
    return stage.progress().beats() >= before + 4;
  }));
  EXPECT_EQ(stage.counters().items, 0U);
  broker->set_connected(true);
  EXPECT_TRUE(eventually(kPatience, [&] { return stage.counters().items == 1; }));
  EXPECT_EQ(stage.ended(), "");
  stage.finish();
  EXPECT_EQ(received.times().size(), 1U);
}

// Each record as large as the broker takes it, and each a place from which a successor goes on.
TEST(OutStage, SplitsLargeOutputIntoSeveralRecords) {
  const auto broker = std::make_shared<FakeBroker>();
  CollectingSink received;
  OutStage stage(begun(broker, 1), received, quick());
  constexpr int kInstants = 40;
  std::vector<std::int64_t> expected;
  for (int ms = 0; ms < kInstants; ++ms) {
    for (const char* const device : {"a", "b", "c"}) {
      stage.location(located(ms, device));
      expected.push_back(us_of(at(ms)));
    }
  }
  stage.advance(at(kInstants));
  broker->most = 1024;
  stage.start();
  ASSERT_TRUE(eventually(kPatience, [&] { return stage.counters().items == expected.size(); }));
  stage.finish();
  EXPECT_GT(stage.counters().records, 10U);
  EXPECT_EQ(stage.counters().left_out, 0U);
  std::vector<std::int64_t> published;
  std::int64_t done = 0;
  for (const v1::OutputRecord& record : records(*broker)) {
    EXPECT_LE(record.ByteSizeLong(), 1024U);
    for (const v1::OutputItem& item : record.output().items()) {
      const auto& time = item.location().time();
      published.push_back(time.seconds() * 1'000'000 + time.nanos() / 1000);
      EXPECT_GE(published.back(), done);
      EXPECT_LT(published.back(), record.output().done_us());
    }
    done = record.has_output() ? record.output().done_us() : done;
  }
  EXPECT_EQ(published, expected);
  EXPECT_TRUE(records(*broker).back().output().released());
}

// One after which nothing comes would be silent for ever.
TEST(OutStage, OmitsResultsOfAnInstantTooLargeForTheBroker) {
  const auto broker = std::make_shared<FakeBroker>();
  CollectingSink received;
  OutStage stage(begun(broker, 1), received, quick());
  for (int device = 0; device < 100; ++device) {
    stage.location(located(1, "device " + std::to_string(device)));
  }
  stage.location(located(2, "a"));
  stage.advance(at(3));
  broker->most = 2048;
  stage.start();
  ASSERT_TRUE(eventually(
      kPatience, [&] { return stage.counters().items + stage.counters().left_out == 101; }));
  EXPECT_GT(stage.counters().left_out, 0U);
  EXPECT_GT(stage.counters().items, 1U);
  EXPECT_EQ(stage.notices().size(), 1U);
  EXPECT_TRUE(stage.notices().empty());
  EXPECT_EQ(received.times().back(), at(2));
  stage.finish();
}

TEST(OutStage, GivesUpTheSiteWhereTheBrokerTakesNothingForTooLong) {
  const auto broker = std::make_shared<FakeBroker>();
  CollectingSink received;
  OutStage::Options options = quick();
  options.most_waiting = 10;
  OutStage stage(begun(broker, 1), received, options);
  stage.start();
  broker->set_connected(false);
  int ms = 0;
  EXPECT_TRUE(eventually(kPatience, [&] {
    stage.location(located(++ms, "a"));
    stage.advance(at(ms + 1));
    return stage.ended() == "the broker takes no results";
  }));
  EXPECT_GT(ms, 10);
}

// The places of a successor: those of a predecessor are used until its own reach back far enough.
TEST(OutStage, ASuccessorWarmsUpFromTheSameInstant) {
  const auto broker = std::make_shared<FakeBroker>();
  CollectingSink received;
  OutStage::Options options = quick();
  std::mutex mutex;
  Timestamp asked;
  options.warm_up = std::chrono::seconds(2);
  options.resume = [&](Timestamp time) {
    const std::lock_guard lock(mutex);
    asked = time;
    return SiteResume{};
  };
  OutStage stage(begun(broker, 1), received, options);
  stage.start();
  for (int s = 1; s <= 6; ++s) {
    Carried carried;
    carried.done = carried.received = at(1000 * s - 100);
    carried.open.at = at(1000 * s);
    stage.carried(std::move(carried));
    stage.advance(at(1000 * s));
  }
  EXPECT_TRUE(eventually(kPatience, [&] {
    const std::lock_guard lock(mutex);
    return asked == at(1900);  // the mark two seconds before, and a second to assemble
  }));
  stage.finish();
  const auto next = begun(broker, 2);
  ASSERT_TRUE(next->start().carried);
  EXPECT_EQ(next->start().carried->done, at(5900));
  EXPECT_EQ(next->start().carried->open.at, at(3000));
}

}  // namespace
}  // namespace rayloc::out_stage_test
