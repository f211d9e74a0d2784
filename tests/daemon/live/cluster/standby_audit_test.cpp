#include "daemon/live/cluster/ownership/standby_audit.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/ownership/out_stage.h"
#include "daemon/live/cluster/ownership/standby_start.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/pipeline/output/carried_message.h"
#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/support/eventually.h"

namespace rayloc::standby_audit_test {
namespace {

using std::chrono::milliseconds;

constexpr std::chrono::seconds kPatience{20};

Timestamp at(int ms) { return Timestamp(std::chrono::hours(500'000)) + milliseconds(ms); }

Location located(int ms, const std::string& device, double x = 1.0) {
  Location location;
  location.target.address = device;
  location.estimate.time = at(ms);
  location.estimate.position = Vec3d{x, 2.0, 1.0};
  location.context.site = "hall";
  return location;
}

// The record of an owner with these results, complete for all instants before `done`.
v1::OutputRecord record_of(std::uint64_t number, int done, const std::vector<Location>& found) {
  OutItems items(Timestamp::min());
  for (const Location& one : found) {
    items.add(Location(one));
  }
  items.advance(at(done));
  v1::OutputRecord record;
  record.set_generation(3);
  record.set_number(number);
  *record.mutable_output() = items.take(1 << 20U).output;
  return record;
}

Carried state(int done, std::uint64_t track) {
  Carried carried;
  carried.done = carried.received = at(done);
  carried.open.at = at(done);
  carried.devices = {track, {{"a", track}}};
  return carried;
}

StandbyAudit::Options of_owner(Likeness likeness = Likeness::kSameBytes) {
  StandbyAudit::Options options;
  options.generation = 3;
  options.likeness = likeness;
  return options;
}

TEST(StandbyAudit, ComparesEachWindowOnceBothSidesAreComplete) {
  StandbyAudit audit(of_owner());
  OutItems own(Timestamp::min());
  const std::vector<Location> found = {located(10, "a"), located(20, "b"), located(30, "a")};
  for (const Location& one : found) {
    own.add(Location(one));
  }
  audit.receive(record_of(7, 15, {found[0]}));  // the audit lacks the start of this window
  audit.receive(record_of(8, 25, {found[1]}));
  audit.receive(record_of(8, 25, {}));  // a repeat
  audit.compare(own, {});
  EXPECT_EQ(audit.counters().windows, 0U);
  own.advance(at(40));
  audit.compare(own, {});
  EXPECT_EQ(audit.counters().windows, 1U);
  EXPECT_EQ(audit.counters().results, 1U);
  EXPECT_EQ(audit.counters().not_compared, 1U);
  EXPECT_EQ(audit.counters().differing, 0U);
  EXPECT_EQ(audit.done(), at(25));
  EXPECT_EQ(own.ready(), 1U);  // not published by the owner yet
  EXPECT_EQ(audit.trouble(), "");
}

TEST(StandbyAudit, FindsDifferentMissingAndExcessResults) {
  StandbyAudit audit(of_owner());
  OutItems own(Timestamp::min());
  for (int ms = 10; ms < 60; ms += 10) {
    own.add(located(ms, "a"));
  }
  own.advance(at(60));
  audit.receive(record_of(1, 5, {}));
  audit.receive(record_of(2, 15, {located(10, "a", 1.0 + 1e-15)}));  // the last digit
  audit.receive(record_of(3, 25, {}));
  audit.receive(record_of(4, 35, {located(30, "a"), located(30, "b")}));
  audit.receive(record_of(5, 45, {located(40, "a")}));
  audit.compare(own, {});
  EXPECT_EQ(audit.counters().windows, 4U);
  EXPECT_EQ(audit.counters().differing, 3U);
  EXPECT_NE(audit.first_difference().find("the owner published"), std::string::npos);
  EXPECT_NE(audit.first_difference().find("0.015000 s"), std::string::npos)
      << audit.first_difference();
}

TEST(StandbyAudit, AllowsPositionDifferencesAfterALaterStart) {
  StandbyAudit audit(of_owner(Likeness::kSameSnapshots));
  OutItems own(Timestamp::min());
  own.add(located(10, "a", 1.001));
  own.add(located(20, "a", 1.001));
  own.advance(at(30));
  audit.receive(record_of(1, 5, {}));
  audit.receive(record_of(2, 15, {located(10, "a")}));
  audit.receive(record_of(3, 25, {located(21, "a")}));
  audit.compare(own, {});
  EXPECT_EQ(audit.counters().differing, 1U);
}

TEST(StandbyAudit, RejectsOtherTrackNumbers) {
  for (const std::uint64_t track : {4U, 5U}) {
    StandbyAudit audit(of_owner());
    OutItems own(Timestamp::min());
    own.advance(at(100));
    v1::OutputRecord record = record_of(2, 90, {});
    *record.mutable_output()->mutable_carried() = carried_message(state(80, 4));
    audit.receive(std::move(record));
    audit.compare(own, {state(70, 9), state(80, track), state(95, 9)});
    EXPECT_EQ(audit.trouble().empty(), track == 4U) << audit.trouble();
  }
}

// A standby that began later may see a target enter or leave a zone a burst earlier or later.
TEST(StandbyAudit, CountsOnlyLastingDifferencesAfterALaterStart) {
  for (const int others : {4, 5}) {
    StandbyAudit audit(of_owner(Likeness::kSameSnapshots));
    OutItems own(Timestamp::min());
    own.advance(at(1000));
    std::deque<Carried> states;
    for (int i = 1; i <= 6; ++i) {
      states.push_back(state(10 * i, i <= others ? 5U : 4U));
      v1::OutputRecord record = record_of(static_cast<std::uint64_t>(i), 10 * i + 5, {});
      *record.mutable_output()->mutable_carried() = carried_message(state(10 * i, 4));
      audit.receive(std::move(record));
    }
    audit.compare(own, states);
    EXPECT_EQ(audit.trouble().empty(), others == 4) << others;
  }
}

TEST(StandbyAudit, AnotherOrAFasterOwnerEndsTheAudit) {
  StandbyAudit another(of_owner());
  v1::OutputRecord begin;
  begin.set_generation(4);
  begin.mutable_begin();
  another.receive(begin);
  EXPECT_EQ(another.trouble(), "another worker owns the site since");
  StandbyAudit::Options options = of_owner();
  options.most_behind = Duration(-1);
  StandbyAudit slow(options);
  for (int i = 1; i < 6; ++i) {
    slow.receive(record_of(static_cast<std::uint64_t>(i), i, {}));
  }
  EXPECT_EQ(slow.trouble(), "it computes more slowly than the owner");
}

class Silent : public LocationSink {
 public:
  void location(Location&& /*location*/) override {}
};

OwnerLog::Options log_options(std::uint64_t generation) {
  OwnerLog::Options options;
  options.site = "hall";
  options.generation = generation;
  options.worker = "w" + std::to_string(generation);
  options.stream = output_stream({});
  return options;
}

OutStage::Options quick() {
  OutStage::Options options;
  options.every = milliseconds(1);
  options.at_most = milliseconds(10);
  options.resume = [](Timestamp) { return SiteResume{}; };
  return options;
}

std::vector<std::int64_t> times_in(const FakeBroker& broker) {
  std::vector<std::int64_t> times;
  for (const BrokerMessage& message : broker.stored()) {
    v1::OutputRecord record;
    if (message.subject == output_subject("hall") && unseal(message.data, record)) {
      for (const v1::OutputItem& item : record.output().items()) {
        times.push_back(item.location().time().nanos() / 1'000'000);
      }
    }
  }
  return times;
}

// The owner dies before it publishes a computed window; the standby publishes it, once.
TEST(Standby, APromotedWorkerContinuesBehindTheOwnersLastRecord) {
  const auto broker = std::make_shared<FakeBroker>();
  Silent silent;
  OutStage owner(*OwnerLog::begin(broker, log_options(3)), silent, quick());
  ASSERT_TRUE(broker->ensure_stream(site_stream("hall", {})));
  owner.start();
  owner.location(located(10, "a"));
  owner.advance(at(15));
  ASSERT_TRUE(eventually(kPatience, [&] { return times_in(*broker).size() == 1; }));
  const auto along = standby_start(*broker, "hall");
  ASSERT_TRUE(along) << along.error().message;
  EXPECT_EQ(along->start.generation, 3U);
  EXPECT_FALSE(along->is_late);
  OutStage follower(along->start, silent, quick(), of_owner());
  auto words = broker->subscribe(output_again_subject("hall"), [&](BrokerMessage&& message) {
    v1::OutputRecord record;
    ASSERT_TRUE(unseal(message.data, record));
    follower.receive(std::move(record));
  });
  follower.location(located(10, "a"));  // computed from where the owner began
  for (OutStage* const stage : {&owner, &follower}) {
    stage->location(located(20, "a"));
    stage->location(located(30, "b"));
    stage->advance(at(25));
  }
  ASSERT_TRUE(eventually(kPatience, [&] { return times_in(*broker).size() == 2; }));
  follower.advance(at(35));
  ASSERT_TRUE(eventually(kPatience, [&] { return follower.standby()->counters.windows > 0; }));
  EXPECT_EQ(follower.standby()->counters.differing, 0U);
  EXPECT_EQ(times_in(*broker).size(), 2U);
  words->reset();  // its own Begin would be that of another
  OwnerLog::Options next = log_options(4);
  next.along = along->start;
  auto log = OwnerLog::begin(broker, next);
  ASSERT_TRUE(log) << log.error().message;
  EXPECT_EQ((*log)->start().from, at(25));
  follower.promote(std::move(*log));
  EXPECT_FALSE(follower.standby());
  ASSERT_TRUE(eventually(kPatience, [&] { return times_in(*broker).size() == 3; }))
      << follower.ended();
  EXPECT_EQ(times_in(*broker), (std::vector<std::int64_t>{10, 20, 30}));
  follower.finish();
  // It followed generation 3, and the last record is of generation 4.
  next.generation = 5;
  EXPECT_FALSE(OwnerLog::begin(broker, next));
}

// Records of the owner are compared until the promotion, also after the decision for it.
TEST(Standby, ReportsAFailedPromotion) {
  const auto broker = std::make_shared<FakeBroker>();
  Silent silent;
  const auto owner = *OwnerLog::begin(broker, log_options(3));
  ASSERT_TRUE(broker->ensure_stream(site_stream("hall", {})));
  v1::SiteOutput output;
  output.set_done_us(us_of(at(5)));
  ASSERT_EQ(owner->append(output), OwnerLog::Outcome::kStored);
  const auto along = standby_start(*broker, "hall");
  ASSERT_TRUE(along) << along.error().message;
  OutStage follower(along->start, silent, quick(), of_owner());
  EXPECT_EQ(follower.standby()->trouble, "");
  OwnerLog::Options next = log_options(4);
  next.along = along->start;
  auto log = OwnerLog::begin(broker, next);
  ASSERT_TRUE(log) << log.error().message;
  v1::OutputRecord another;
  another.set_generation(5);
  another.mutable_begin();
  follower.receive(std::move(another));
  follower.promote(std::move(*log));
  EXPECT_EQ(follower.ended(), "another worker owns the site since");
  follower.finish();
}

TEST(Standby, IsLateIfTheStreamLostItsBeginning) {
  const auto broker = std::make_shared<FakeBroker>();
  EXPECT_FALSE(standby_start(*broker, "hall"));
  const auto log = *OwnerLog::begin(broker, log_options(3));
  ASSERT_TRUE(broker->ensure_stream(site_stream("hall", {})));
  v1::SiteOutput output;
  output.set_done_us(us_of(at(5)));
  ASSERT_EQ(log->append(output), OwnerLog::Outcome::kStored);
  EXPECT_FALSE(standby_start(*broker, "hall")->is_late);
  broker->drop(std::string(kOutputStream), 1);  // its Begin
  const auto late = standby_start(*broker, "hall");
  EXPECT_TRUE(late->is_late);
  EXPECT_EQ(late->start.from, at(5));
  output.set_released(true);
  ASSERT_EQ(log->append(output), OwnerLog::Outcome::kStored);
  EXPECT_FALSE(standby_start(*broker, "hall"));
}

}  // namespace
}  // namespace rayloc::standby_audit_test
