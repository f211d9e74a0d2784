// Claims of as many sites and workers as a cluster has: every site has one owner, the sites of
// workers that die go to the others, and no worker has more than rendezvous hashing explains.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "daemon/live/cluster/ownership/claim_rule.h"
#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/support/eventually.h"

namespace rayloc::claims_at_scale_test {
namespace {

constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::seconds kLease{2};
constexpr double kRare = 1e-6;  // chosen: the chance that a fair distribution fails the test

struct Scale {
  std::size_t sites;
  std::size_t workers;
  std::size_t dying;
};

std::ostream& operator<<(std::ostream& out, const Scale& scale) {
  return out << scale.sites << "_sites_" << scale.workers << "_workers";
}

std::string site_name(std::size_t site) { return "site " + std::to_string(site); }
std::string worker_name(std::size_t worker) { return "w" + std::to_string(worker); }

// Probability of `count` of `sites` for one of `workers`, if each is chosen by an even hash.
double chance_of(std::size_t count, std::size_t sites, std::size_t workers) {
  const auto n = static_cast<double>(sites);
  const auto k = static_cast<double>(count);
  const double p = 1.0 / static_cast<double>(workers);
  return std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) +
                  k * std::log(p) + (n - k) * std::log1p(-p));
}

// Any of the workers has more with a chance below kRare.
std::size_t most_sites(std::size_t sites, std::size_t workers) {
  double chance = 0.0;
  std::size_t count = sites;
  for (; count > 0; --count) {
    chance += chance_of(count, sites, workers);
    if (static_cast<double>(workers) * chance >= kRare) {
      break;
    }
  }
  return count;
}

// Any of the workers has fewer with a chance below kRare.
std::size_t fewest_sites(std::size_t sites, std::size_t workers) {
  double chance = 0.0;
  std::size_t count = 0;
  for (; count < sites; ++count) {
    chance += chance_of(count, sites, workers);
    if (static_cast<double>(workers) * chance >= kRare) {
      break;
    }
  }
  return count;
}

// A worker, and the sites that it owns by the changes that its keeper reports.
class Worker {
 public:
  Worker(const std::shared_ptr<FakeBroker>& broker, const std::string& name, std::size_t sites) {
    ClaimKeeper::Options options;
    options.worker = name;
    options.incarnation = 1;
    options.lease = kLease;
    options.all_sites = sites;
    options.stream = claim_stream({});
    keeper_ = *ClaimKeeper::open(broker, std::move(options));
    keeper_->start();
  }
  void offer(std::size_t sites) {
    for (std::size_t i = 0; i < sites; ++i) {
      keeper_->offer(site_name(i));
    }
  }
  // Its thread makes eight rounds in a lease.
  std::uint64_t rounds() const { return keeper_->progress().beats(); }
  // Generations by site.
  const std::map<std::string, std::uint64_t>& owned() {
    for (const ClaimKeeper::Change& change : keeper_->take_changes()) {
      if (change.generation > 0) {
        owned_[change.site] = change.generation;
      } else {
        owned_.erase(change.site);
      }
    }
    return owned_;
  }

 private:
  std::unique_ptr<ClaimKeeper> keeper_;
  std::map<std::string, std::uint64_t> owned_;
};

class ClaimsAtScale : public ::testing::TestWithParam<Scale> {
 protected:
  // Every site has one owner.
  bool all_owned() {
    std::set<std::string> sites;
    std::size_t owned = 0;
    for (const auto& worker : workers_) {
      for (const auto& [site, generation] : worker->owned()) {
        sites.insert(site);
        ++owned;
      }
    }
    return owned == GetParam().sites && sites.size() == GetParam().sites;
  }
  void expect_balance() {
    const std::size_t most = most_sites(GetParam().sites, workers_.size());
    for (const auto& worker : workers_) {
      EXPECT_LE(worker->owned().size(), most);
    }
  }
  // Starts all workers, which receive each other before they claim anything.
  void start() {
    for (std::size_t i = 0; i < GetParam().workers; ++i) {
      workers_.push_back(std::make_unique<Worker>(broker_, worker_name(i), GetParam().sites));
    }
    constexpr std::uint64_t kRounds = 12;  // a lease and a half
    ASSERT_TRUE(eventually(kPatience, [&] {
      return std::all_of(workers_.begin(), workers_.end(), [&](const auto& worker) {
        return worker->rounds() >= kRounds;
      });
    }));
    for (const auto& worker : workers_) {
      worker->offer(GetParam().sites);
    }
  }

  const std::shared_ptr<FakeBroker> broker_ = std::make_shared<FakeBroker>();
  std::vector<std::unique_ptr<Worker>> workers_;
};

TEST_P(ClaimsAtScale, EverySiteHasOneOwnerAlsoAfterWorkersDie) {
  start();
  ASSERT_TRUE(eventually(kPatience, [&] { return all_owned(); }));
  expect_balance();
  std::map<std::string, std::uint64_t> orphans;
  for (std::size_t i = 0; i < GetParam().dying; ++i) {
    orphans.insert(workers_.back()->owned().begin(), workers_.back()->owned().end());
    workers_.pop_back();  // sends nothing any more
  }
  ASSERT_FALSE(orphans.empty());
  std::vector<std::map<std::string, std::uint64_t>> before;
  for (const auto& worker : workers_) {
    before.push_back(worker->owned());
  }
  ASSERT_TRUE(eventually(kPatience, [&] { return all_owned(); }));
  expect_balance();
  std::size_t heirs = 0;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    for (const auto& [site, generation] : before[i]) {
      EXPECT_EQ(workers_[i]->owned().count(site), 1U) << site << " has moved without need";
    }
    heirs += workers_[i]->owned().size() > before[i].size() ? 1U : 0U;
    for (const auto& [site, generation] : workers_[i]->owned()) {
      if (orphans.count(site) == 1) {
        EXPECT_GT(generation, orphans.at(site)) << site;
      }
    }
  }
  EXPECT_GT(heirs, 1U);
}

// The rule alone, for workers without sites: the first choice of each site.
TEST_P(ClaimsAtScale, HashingSpreadsSitesAsEvenlyAsChance) {
  const auto [sites, workers, dying] = GetParam();
  std::vector<Candidate> candidates(workers);
  for (std::size_t i = 0; i < workers; ++i) {
    candidates[i].worker = worker_name(i);
  }
  std::vector<std::size_t> first(workers);
  for (std::size_t site = 0; site < sites; ++site) {
    for (std::size_t i = 0; i < workers; ++i) {
      first[i] += rank_of(worker_name(i), site_name(site), sites, candidates) == 0 ? 1U : 0U;
    }
  }
  std::size_t all = 0;
  for (const std::size_t count : first) {
    EXPECT_GE(count, fewest_sites(sites, workers));
    EXPECT_LE(count, most_sites(sites, workers));
    all += count;
  }
  EXPECT_EQ(all, sites);
}

INSTANTIATE_TEST_SUITE_P(Clusters,
                         ClaimsAtScale,
                         ::testing::Values(Scale{200, 40, 4}, Scale{1000, 3, 1}));

}  // namespace
}  // namespace rayloc::claims_at_scale_test
