#include "daemon/live/cluster/ownership/claim_keeper.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/ownership/claim_streams.h"
#include "daemon/live/cluster/sealed_message.h"
#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/support/eventually.h"

namespace rayloc::claim_keeper_test {
namespace {

using std::chrono::milliseconds;

constexpr std::chrono::seconds kPatience{60};
constexpr std::size_t kSites = 20;

TEST(ClaimRule, AWorkerThatDiesLeavesItsSitesToAllOthersAlike) {
  std::vector<Candidate> workers = {{"w1"}, {"w2"}, {"w3"}, {"w4"}};
  std::map<std::string, std::size_t> given;
  constexpr std::size_t kMany = 400;
  for (std::size_t i = 0; i < kMany; ++i) {
    const std::string site = "site " + std::to_string(i);
    std::size_t first = 0;
    for (Candidate& worker : workers) {
      if (rank_of(worker.worker, site, kMany, workers) == 0) {
        ++worker.sites;
        ++first;
        break;
      }
    }
    EXPECT_EQ(first, 1U) << site;
  }
  for (const Candidate& worker : workers) {
    EXPECT_GE(worker.sites, kMany / 8) << worker.worker;
    EXPECT_LE(worker.sites, kMany * 116 / 100 / 4 + 1) << worker.worker;
  }
}

TEST(ClaimRule, AFullWorkerBlocksNoOther) {
  const std::vector<Candidate> workers = {{"full", 3, 3}, {"free", 0, 3}};
  for (const char* const site : {"a", "b", "c", "d"}) {
    EXPECT_EQ(rank_of("free", site, 4, workers), 0U);
  }
  EXPECT_TRUE(is_full(workers.front()));
  EXPECT_FALSE(is_full({"any", 1000, 0}));
}

TEST(ClaimRule, TheStandbyOfASiteRanksFirst) {
  std::vector<Candidate> workers = {{"w1", 0}, {"w2", 9}, {"w3", 0}};
  EXPECT_NE(rank_of("w2", "a", 9, workers), 0U);
  workers[1].stands_by = true;
  EXPECT_EQ(rank_of("w2", "a", 9, workers), 0U);
  workers[1].capacity = 9;
  EXPECT_EQ(rank_of("w1", "a", 9, workers) + rank_of("w3", "a", 9, workers), 1U);
}

TEST(ClaimRule, AnOverloadedWorkerRanksLast) {
  std::vector<Candidate> workers = {{"w1", 0}, {"w2", 9}, {"w3", 0}};
  workers[0].is_behind = workers[2].is_behind = true;
  EXPECT_EQ(rank_of("w2", "a", 9, workers), 0U);
  workers[1].capacity = 9;
  EXPECT_EQ(rank_of("w1", "a", 9, workers) + rank_of("w3", "a", 9, workers), 1U);
}

// A worker, and the sites that it owns by the changes that its keeper reports.
struct Worker {
  Worker(const std::shared_ptr<FakeBroker>& broker,
         const std::string& name,
         std::size_t capacity,
         std::uint64_t incarnation = 1) {
    ClaimKeeper::Options options;
    options.worker = name;
    options.incarnation = incarnation;
    options.lease = milliseconds(1000);
    options.capacity = capacity;
    options.all_sites = kSites;
    options.stream = claim_stream({});
    keeper = *ClaimKeeper::open(broker, std::move(options));
    for (std::size_t i = 0; i < kSites; ++i) {
      keeper->offer("site " + std::to_string(i));
    }
    keeper->start();
  }
  std::size_t owned() {
    for (const ClaimKeeper::Change& change : keeper->take_changes()) {
      if (change.generation > 0) {
        sites[change.site] = change.generation;
      } else {
        sites.erase(change.site);
      }
    }
    return sites.size();
  }
  // Waits until it has judged all its sites once more: it then claims a site that is offered to no
  // other worker, and that it judges last. That site is withdrawn again.
  bool judges() {
    const std::string last = "the last site";
    keeper->offer(last);
    const bool claimed = eventually(kPatience, [&] {
      owned();
      return sites.count(last) == 1;
    });
    keeper->withdraw(last);
    sites.erase(last);
    return claimed;
  }
  // Waits for its thread, which makes eight rounds in a lease.
  bool checks(std::uint64_t times) const {
    const StageProgress& progress = keeper->progress();
    return eventually(
        kPatience, [&, before = progress.beats()] { return progress.beats() >= before + times; });
  }
  std::unique_ptr<ClaimKeeper> keeper;
  std::map<std::string, std::uint64_t> sites;  // generations
};

TEST(ClaimKeeper, EverySiteHasOneOwnerAndOneThatDiesIsReplaced) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 0);
  auto second = std::make_unique<Worker>(broker, "w2", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() + second->owned() == kSites; }));
  EXPECT_GT(first.sites.size(), 0U);
  EXPECT_GT(second->sites.size(), 0U);
  for (const auto& [site, generation] : first.sites) {
    EXPECT_EQ(second->sites.count(site), 0U);
    EXPECT_EQ(generation, 1U);
  }
  const auto before = second->sites;
  second.reset();  // sends nothing any more
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() == kSites; }));
  for (const auto& [site, generation] : before) {
    EXPECT_EQ(first.sites.at(site), generation + 1);
  }
}

TEST(ClaimKeeper, ReturnedAndExcessSitesGoToOthers) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 5);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() == 5; }));
  Worker second(broker, "w2", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return second.owned() == kSites - 5; }));
  const auto before = first.sites;
  first.keeper->leave();
  for (const auto& [site, generation] : before) {
    first.keeper->give_back(site, generation);
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return second.owned() == kSites; }));
  EXPECT_EQ(second.keeper->owner_of(before.begin()->first), "w2");
}

TEST(ClaimKeeper, ASiteReturnedByABusyWorkerGoesToAnIdleOne) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() == kSites; }));
  EXPECT_FALSE(first.keeper->calmest());
  v1::WorkerState behind;
  behind.set_shedding(2);
  behind.set_load_permille(950);
  first.keeper->set_condition(behind);
  Worker second(broker, "w2", 3);
  v1::WorkerState calm;
  calm.set_load_permille(250);
  second.keeper->set_condition(calm);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.keeper->calmest() == 0.25; }));
  EXPECT_FALSE(second.keeper->calmest()) << "the other one is behind";
  ASSERT_TRUE(second.judges()) << "it has heard itself for a lease";
  const auto before = first.sites;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string site = "site " + std::to_string(i);
    first.keeper->give_back(site, before.at(site));
    first.keeper->offer(site);  // it is prepared anew
    EXPECT_TRUE(eventually(kPatience, [&] { return second.owned() == i + 1; })) << i;
    EXPECT_EQ(second.sites.count(site), 1U);
  }
  ASSERT_TRUE(eventually(kPatience, [&] { return !first.keeper->calmest(); })) << "it is full";
}

// The worker that offers the site has not been notified that it was removed.
TEST(ClaimKeeper, ASiteThatWasRemovedIsClaimedOnceItIsThereAgain) {
  const auto broker = std::make_shared<FakeBroker>();
  const std::string site = "site 3";
  ASSERT_TRUE(broker->ensure_stream(claim_stream({})));
  v1::SiteClaim record;
  record.set_generation(7);
  record.set_removed(true);
  const auto removed = broker->publish_behind(claim_subject(site), seal(record), 0);
  ASSERT_TRUE(removed && removed->is_last);
  Worker worker(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return worker.owned() == kSites - 1; }));
  ASSERT_TRUE(worker.judges());
  EXPECT_EQ(worker.owned(), kSites - 1);
  record.set_removed(false);
  ASSERT_TRUE(broker->publish_behind(claim_subject(site), seal(record), removed->sequence));
  ASSERT_TRUE(eventually(kPatience, [&] { return worker.owned() == kSites; }));
  EXPECT_EQ(worker.sites.at(site), 8U);
}

TEST(ClaimKeeper, ASiteReturnedWithoutABrokerIsReleasedLater) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 0);
  Worker second(broker, "w2", 1);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() + second.owned() == kSites; }));
  const std::string site = first.sites.begin()->first;
  const std::uint64_t generation = first.sites.begin()->second;
  first.keeper->give_back(site, generation - 1);  // of an older claim
  broker->set_connected(false);
  first.keeper->give_back(site, generation);
  ASSERT_TRUE(first.checks(2));
  EXPECT_EQ(first.keeper->owner_of(site), "w1");
  broker->set_connected(true);
  EXPECT_TRUE(eventually(kPatience, [&] { return second.keeper->owner_of(site).empty(); }));
  EXPECT_EQ(first.owned() + second.owned(), kSites);  // a release alone is not reported
}

// A claim whose owner is alive and does not list the site.
TEST(ClaimKeeper, AnOwnerThatDoesNotNameItsSiteDoesNotHaveIt) {
  const auto broker = std::make_shared<FakeBroker>();
  ASSERT_TRUE(broker->ensure_stream(claim_stream({})));
  v1::SiteClaim orphan;
  orphan.set_worker("w1");
  orphan.set_incarnation(1);
  orphan.set_generation(5);
  ASSERT_TRUE(broker->publish_behind(claim_subject("site 0"), seal(orphan), 0));
  const v1::WorkerState alive = [] {
    v1::WorkerState state;
    state.set_worker("w1");
    state.set_incarnation(1);
    state.set_leaving(true);
    return state;
  }();
  Worker second(broker, "w2", 0);
  EXPECT_TRUE(eventually(kPatience, [&] {
    EXPECT_TRUE(broker->publish(worker_subject("w1"), seal(alive)));
    return second.owned() == kSites;
  }));
  EXPECT_EQ(second.sites.at("site 0"), 6U);
}

// A worker without answers stays alive: its reports wait for no answer.
TEST(ClaimKeeper, ASlowBrokerMakesNoWorkerAppearDead) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker only(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return only.owned() == kSites; }));
  broker->set_answering(false);
  only.keeper->offer("another site");
  std::atomic<int> words = 0;
  const auto states = broker->subscribe(worker_subject("w1"), [&](BrokerMessage&&) { ++words; });
  EXPECT_TRUE(eventually(kPatience, [&] { return words >= 8; }));  // two leases
  broker->set_answering(true);
  EXPECT_TRUE(eventually(kPatience, [&] { return only.owned() == kSites + 1; }));
}

TEST(ClaimKeeper, ALostStoreTransfersNoSites) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() == kSites; }));
  const auto before = first.sites;
  broker->set_connected(false);
  broker->forget_streams(std::chrono::seconds(1));
  broker->set_connected(true);
  Worker late(broker, "w2", 0);
  EXPECT_TRUE(eventually(kPatience, [&] { return broker->stored().size() == kSites; }));
  ASSERT_TRUE(late.judges());
  EXPECT_EQ(late.owned(), 0U);
  EXPECT_EQ(first.owned(), kSites);
  EXPECT_EQ(first.sites, before);
  for (const auto& [site, generation] : before) {
    first.keeper->give_back(site, generation);
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return late.owned() == kSites; }));
  for (const auto& [site, generation] : late.sites) {
    EXPECT_GT(generation, before.at(site) + 900) << "of a stream that is a second younger";
  }
}

TEST(ClaimKeeper, OneOfTwoNamesakesClaimsNothingAndReportsWhy) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() == kSites; }));
  Worker namesake(broker, "w1", 0, 2);
  EXPECT_TRUE(eventually(kPatience, [&] { return !namesake.keeper->trouble().empty(); }));
  ASSERT_TRUE(namesake.checks(12)) << "for more than a lease";
  ASSERT_TRUE(first.judges());
  EXPECT_EQ(first.keeper->trouble(), "");
  EXPECT_EQ(first.owned(), kSites);
  EXPECT_EQ(namesake.owned(), 0U);
  first.keeper->finish();  // sends nothing any more
  EXPECT_TRUE(eventually(kPatience, [&] { return namesake.owned() == kSites; }));
  EXPECT_EQ(namesake.keeper->trouble(), "");
}

// A claim of a worker that does not live, by a client that may write claims.
class ForgedClaim : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(ForgedClaim, CostsItsSiteOneChangeOfOwner) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 0);
  Worker second(broker, "w2", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() + second.owned() == kSites; }));
  const auto others = first.sites;
  ASSERT_FALSE(others.empty());
  const auto [site, generation] = *others.begin();
  const auto last = broker->last_of(std::string(kClaimStream), claim_subject(site));
  ASSERT_TRUE(last && *last);
  v1::SiteClaim forged;
  forged.set_worker("nobody");
  forged.set_incarnation(9);
  forged.set_generation(GetParam() == 0 ? generation + 5 : GetParam());
  const bool is_counted = forged.generation() < std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t next = (is_counted ? forged.generation() : generation) + 1;
  ASSERT_TRUE(broker->publish_behind(claim_subject(site), seal(forged), (*last)->sequence));
  const auto has_next = [&, &name = site](Worker& worker) {
    worker.owned();
    const auto owned = worker.sites.find(name);
    return owned != worker.sites.end() && owned->second == next;
  };
  EXPECT_TRUE(eventually(kPatience, [&] { return has_next(first) || has_next(second); }));
  EXPECT_TRUE(eventually(kPatience, [&] { return first.owned() + second.owned() == kSites; }));
  for (const auto& [other, its] : others) {
    EXPECT_TRUE(other == site || first.sites.at(other) == its) << other;
  }
}

// The record of its last owner is gone; the results show that owner's generation.
TEST_P(ForgedClaim, DoesNotBindAWorkerThatStartsLaterBelowTheResults) {
  const auto broker = std::make_shared<FakeBroker>();
  ASSERT_TRUE(make_worker_streams(*broker, claim_stream({}), std::chrono::minutes(10)));
  const std::string site = "site 3";
  constexpr std::uint64_t kGeneration = 70;
  v1::OutputRecord result;
  result.set_generation(kGeneration);
  ASSERT_TRUE(broker->publish_behind(output_subject(site), seal(result), 0));
  v1::SiteClaim forged;
  forged.set_worker("nobody");
  forged.set_incarnation(9);
  forged.set_generation(GetParam() == 0 ? kGeneration - 5 : GetParam());
  const bool is_higher = forged.generation() > kGeneration &&
                         forged.generation() < std::numeric_limits<std::uint64_t>::max();
  ASSERT_TRUE(broker->publish_behind(claim_subject(site), seal(forged), 0));
  Worker late(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return late.owned() == kSites; }));
  EXPECT_EQ(late.sites.at(site), (is_higher ? forged.generation() : kGeneration) + 1);
  // Another worker reads the claim that follows the forged one.
  Worker other(broker, "w2", 0);
  ASSERT_TRUE(other.judges());
  EXPECT_EQ(other.keeper->owner_of(site), "w1");
  EXPECT_EQ(other.owned(), 0U);
  EXPECT_EQ(late.owned(), kSites);
}

constexpr std::uint64_t kExact = std::uint64_t{1} << 53U;  // of a double

INSTANTIATE_TEST_SUITE_P(
    Generations,
    ForgedClaim,
    ::testing::Values(0, kExact - 1, kExact, std::numeric_limits<std::uint64_t>::max()));

// The others of the dead owner's sites are due no earlier.
TEST(ClaimKeeper, AStandbyClaimsItsSitesFirst) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker first(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return first.owned() == kSites; }));
  Worker second(broker, "w2", 0);
  ASSERT_TRUE(second.judges());
  v1::WorkerState standby;
  standby.add_stands_by()->set_site("site 7");
  second.keeper->set_condition(standby);
  first.keeper->finish();  // sends nothing any more
  std::vector<std::string> claimed;
  EXPECT_TRUE(eventually(kPatience, [&] {
    for (const ClaimKeeper::Change& change : second.keeper->take_changes()) {
      claimed.push_back(change.site);
    }
    return claimed.size() == kSites;
  }));
  ASSERT_FALSE(claimed.empty());
  EXPECT_EQ(claimed.front(), "site 7");
}

TEST(PeerWatch, AnOwnerIsSilentAfterThePatienceOfItsJudge) {
  PeerWatch watch({"w1", 1}, milliseconds(1000));
  const PeerWatch::Time now = std::chrono::steady_clock::now();
  v1::WorkerState state;
  state.set_worker("w2");
  state.set_incarnation(1);
  state.add_sites("hall");
  watch.take(state, 0, now);
  const PeerWatch::Owner owner{{"w2", 1}, {}};
  EXPECT_TRUE(watch.has(owner, "hall", milliseconds(750), now + milliseconds(749)));
  EXPECT_FALSE(watch.has(owner, "hall", milliseconds(750), now + milliseconds(750)));
  EXPECT_TRUE(watch.has(owner, "hall", milliseconds(1000), now + milliseconds(750)));
  EXPECT_FALSE(watch.has(owner, "lab", milliseconds(1000), now));
  EXPECT_TRUE(watch.has({owner.start, now}, "lab", milliseconds(1000), now)) << "it has just come";
  EXPECT_EQ(watch.received(owner.start), now);
  EXPECT_FALSE(watch.received({"w2", 2}));
}

// Reports are sent every 250 ms and a moment.
TEST(PeerWatch, AHotStandbyToleratesTwoLostReportsAndNotThree) {
  PeerWatch watch({"w1", 1}, milliseconds(1000));
  const PeerWatch::Time begin = std::chrono::steady_clock::now();
  v1::WorkerState owner;
  owner.set_worker("w2");
  owner.set_incarnation(1);
  owner.add_sites("hall");
  v1::WorkerState own;
  own.set_worker("w1");
  own.set_incarnation(1);
  const PeerWatch::Owner of_hall{{"w2", 1}, {}};
  const auto has = [&](bool stands_by, PeerWatch::Time now) {
    return watch.has(of_hall, "hall", watch.patience(stands_by, now), now);
  };
  watch.take(owner, 0, begin);
  watch.take(own, 0, begin + milliseconds(600));
  constexpr milliseconds kThird = 3 * (milliseconds(250) + milliseconds(10));
  EXPECT_TRUE(has(true, begin + kThird));
  watch.take(owner, 0, begin + kThird);
  watch.take(own, 0, begin + kThird + milliseconds(600));
  EXPECT_TRUE(has(true, begin + kThird + milliseconds(874)));
  EXPECT_FALSE(has(true, begin + kThird + milliseconds(875))) << "before a fourth can arrive";
  EXPECT_TRUE(has(false, begin + kThird + milliseconds(999)));
  EXPECT_FALSE(has(false, begin + kThird + milliseconds(1000)));
}

TEST(PeerWatch, AHotStandbyWithoutItsOwnReportsWaitsForALease) {
  PeerWatch watch({"w1", 1}, milliseconds(1000));
  const PeerWatch::Time begin = std::chrono::steady_clock::now();
  v1::WorkerState own;
  own.set_worker("w1");
  own.set_incarnation(1);
  EXPECT_EQ(watch.hot_patience(), milliseconds(875));
  EXPECT_EQ(watch.patience(true, begin), milliseconds(1000)) << "none has arrived";
  watch.take(own, 0, begin);
  // One of them may be lost.
  EXPECT_EQ(watch.patience(true, begin + milliseconds(520)), watch.hot_patience());
  EXPECT_EQ(watch.patience(true, begin + milliseconds(624)), watch.hot_patience());
  EXPECT_EQ(watch.patience(true, begin + milliseconds(625)), milliseconds(1000));
  EXPECT_EQ(watch.patience(false, begin), milliseconds(1000));
}

TEST(PeerWatch, ReceivesItselfWhileItsOwnReportsArrive) {
  PeerWatch watch({"w1", 1}, milliseconds(1000));
  const PeerWatch::Time now = std::chrono::steady_clock::now();
  EXPECT_FALSE(watch.receives_itself(now, milliseconds(500)));
  v1::WorkerState own;
  own.set_worker("w1");
  own.set_incarnation(1);
  watch.take(own, 0, now);
  EXPECT_TRUE(watch.receives_itself(now + milliseconds(499), milliseconds(500)));
  EXPECT_FALSE(watch.receives_itself(now + milliseconds(500), milliseconds(500)));
}

TEST(PeerWatch, ForgetsSilentPeers) {
  PeerWatch watch({"w1", 1}, milliseconds(1000));
  PeerWatch::Time now = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) {
    v1::WorkerState state;
    state.set_worker("w" + std::to_string(i));
    state.set_incarnation(1);
    watch.take(state, 0, now);
    now += milliseconds(500);
  }
  EXPECT_LT(watch.size(), 25U);
}

TEST(ClaimKeeper, NoWorkerLosesASiteWhileTheBrokerIsAbsent) {
  const auto broker = std::make_shared<FakeBroker>();
  Worker only(broker, "w1", 0);
  ASSERT_TRUE(eventually(kPatience, [&] { return only.owned() == kSites; }));
  broker->set_connected(false);
  ASSERT_TRUE(only.checks(20)) << "for more than two leases";
  broker->set_connected(true);
  Worker late(broker, "w2", 0);
  ASSERT_TRUE(late.judges());
  EXPECT_EQ(only.owned(), kSites);
  EXPECT_EQ(late.owned(), 0U);
}

}  // namespace
}  // namespace rayloc::claim_keeper_test
