#include "daemon/live/cluster/ownership/claim_keeper.h"

#include <pthread.h>

#include <algorithm>
#include <array>
#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/ownership/owner_log.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/live/cluster/site_start.h"
#include "daemon/pipeline/record/system_now.h"

namespace rayloc {
namespace {

constexpr int kLeaseChecks = 2 * PeerWatch::kReports;
constexpr int kHotChecks = 50;  // chosen: per lease, 40 ms of the preset; they send no requests
// Interval between requests for a known claim: the message with a change may be lost.
constexpr std::chrono::seconds kClaimReadInterval{5};
// Generations are milliseconds since 1970 and a number of claims. From here on they are forged.
constexpr std::uint64_t kForgedGeneration = std::uint64_t{1} << 63U;

std::uint32_t milliseconds_of(Duration lease) {
  return static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(lease).count());
}

}  // namespace

ClaimKeeper::ClaimKeeper(std::shared_ptr<Broker> broker, Options options)
    : broker_(std::move(broker)),
      options_(std::move(options)),
      peers_({options_.worker, options_.incarnation}, options_.lease) {}

ClaimKeeper::~ClaimKeeper() { finish(); }

Expected<std::unique_ptr<ClaimKeeper>> ClaimKeeper::open(std::shared_ptr<Broker> broker,
                                                         Options options) {
  std::unique_ptr<ClaimKeeper> keeper(new ClaimKeeper(std::move(broker), std::move(options)));
  ClaimKeeper* const self = keeper.get();
  struct Wanted {
    std::string subject;
    Broker::Handler handler;
    std::unique_ptr<Broker::Subscription>& to;
  };
  const std::array<Wanted, 3> all = {{{std::string(kWorkerSubjects),
                                       [self](BrokerMessage&& m) { self->take_state(m); },
                                       self->states_},
                                      {std::string(kClaimsAgain),
                                       [self](BrokerMessage&& m) { self->take_claim(m); },
                                       self->claimed_},
                                      {drain_subject(self->options_.worker),
                                       [self](BrokerMessage&& m) {
                                         v1::DrainRequest request;
                                         if (unseal(m.data, request) &&
                                             request.worker() == self->options_.worker) {
                                           self->leave();
                                         }
                                       },
                                       self->drains_}}};
  for (const Wanted& one : all) {
    auto made = self->broker_->subscribe(one.subject, one.handler);
    RAYLOC_TRY(made);
    one.to = std::move(*made);
  }
  return keeper;
}

void ClaimKeeper::start() {
  sender_ = std::thread([this] { send_state(); });
  thread_ = std::thread([this] { run(); });
}

void ClaimKeeper::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  send_.notify_one();
  for (std::thread* const thread : {&thread_, &sender_}) {
    if (thread->joinable()) {
      thread->join();
    }
  }
}

void ClaimKeeper::offer(const std::string& site) {
  const std::lock_guard lock(mutex_);
  offered_.insert(site);
}

void ClaimKeeper::leave() {
  leaving_ = true;
  {
    const std::lock_guard lock(mutex_);
    send_now_ = true;
  }
  send_.notify_one();
}

void ClaimKeeper::take_state(const BrokerMessage& message) {
  v1::WorkerState state;
  if (!unseal(message.data, state) || state.worker().empty()) {
    return;
  }
  const std::lock_guard lock(mutex_);
  peers_.take(state, owned_.size(), std::chrono::steady_clock::now());
}

void ClaimKeeper::take_claim(const BrokerMessage& message) {
  v1::SiteClaim claim;
  if (unseal(message.data, claim)) {
    note(token_name(last_token(message.subject)), message.sequence, claim);
  }
}

// Takes a record of the stream of claims. A replaced owner loses the site here. A forged generation
// is not exceeded by the next claim: that one follows the results.
void ClaimKeeper::note(const std::string& site,
                       std::uint64_t sequence,
                       const v1::SiteClaim& claim) {
  const std::lock_guard lock(mutex_);
  Claim& known = claims_[site];
  if (sequence < known.sequence) {
    return;
  }
  if (sequence > known.sequence) {
    known.noted = std::chrono::steady_clock::now();
  }
  known.sequence = sequence;
  known.claim = claim;
  if (claim.generation() < kForgedGeneration) {
    known.highest = std::max(known.highest, claim.generation());
  }
  const auto owned = owned_.find(site);
  const bool is_ours =
      claim.worker() == options_.worker && claim.incarnation() == options_.incarnation;
  if (owned != owned_.end() && claim.generation() > owned->second && !is_ours) {
    owned_.erase(owned);
    offered_.erase(site);
    changes_.push_back({site, 0, claim.worker()});
  }
}

// Waits for no replies: a slow broker makes no worker appear dead.
void ClaimKeeper::send_state() {
  pthread_setname_np(pthread_self(), "alive");  // for top -H
  std::unique_lock lock(mutex_);
  while (!finishing_) {
    sending_.beat();
    const bool yields = peers_.yields(std::chrono::steady_clock::now());
    const std::string alive = seal(state());
    lock.unlock();
    if (!yields && broker_->connected()) {
      (void)broker_->publish(worker_subject(options_.worker), alive);  // repeated soon
    }
    lock.lock();
    sending_.rest();
    send_.wait_for(
        lock, options_.lease / PeerWatch::kReports, [&] { return finishing_ || send_now_; });
    send_now_ = false;
  }
  sending_.rest();
}

// REQUIRES: the mutex is held.
v1::WorkerState ClaimKeeper::state() const {
  v1::WorkerState state = condition_;
  state.set_worker(options_.worker);
  state.set_incarnation(options_.incarnation);
  state.set_capacity(static_cast<std::uint32_t>(options_.capacity));
  state.set_arithmetic(arithmetic());
  state.set_leaving(leaving_);
  state.set_lease_ms(milliseconds_of(options_.lease));
  state.set_now_us(us_of(system_now()));
  for (const auto& [site, generation] : owned_) {
    state.add_sites(site);
  }
  return state;
}

void ClaimKeeper::run() {
  pthread_setname_np(pthread_self(), "claims");  // for top -H
  bool goes_on = true;
  while (goes_on) {
    {
      std::unique_lock lock(mutex_);
      progress_.rest();
      wake_.wait_for(lock, check_period(std::chrono::steady_clock::now()), [&] {
        return finishing_ || check_now_;
      });
      check_now_ = false;
      goes_on = !finishing_;
      progress_.beat();
    }
    if (!broker_->connected()) {
      continue;
    }
    return_sites();
    if (goes_on && see_to_streams()) {
      restore_claims();
      see_to_sites();
    }
  }
  progress_.rest();
}

v1::SiteClaim ClaimKeeper::claim_of(std::uint64_t generation) const {
  v1::SiteClaim claim;
  claim.set_worker(options_.worker);
  claim.set_incarnation(options_.incarnation);
  claim.set_generation(generation);
  claim.set_lease_ms(milliseconds_of(options_.lease));
  return claim;
}

// REQUIRES: the mutex is held, as for is_due().
bool ClaimKeeper::has_owner(const std::string& site, const Claim& known, Time now) const {
  if (known.sequence == 0) {
    return peers_.any_peer_has(site, now);  // its claim was lost with the store
  }
  const v1::SiteClaim& claim = known.claim;
  if (claim.removed() && now - known.noted < kRemovedFor) {
    return true;
  }
  // Our own claim without a recorded ownership: its reply was lost, and the next one replaces it.
  if (claim.worker().empty() ||
      (claim.worker() == options_.worker && claim.incarnation() == options_.incarnation)) {
    return false;
  }
  return peers_.has({{claim.worker(), claim.incarnation()}, known.noted},
                    site,
                    peers_.patience(stands_by(site), now),
                    now);
}

// REQUIRES: the mutex is held.
bool ClaimKeeper::stands_by(const std::string& site) const {
  const auto& along = condition_.stands_by();
  return std::any_of(
      along.begin(), along.end(), [&](const auto& one) { return one.site() == site; });
}

// REQUIRES: the mutex is held. A silent owner is detected soon, and by its standby at once.
Duration ClaimKeeper::check_period(Time now) const {
  const auto& along = condition_.stands_by();
  Duration period = options_.lease / (along.empty() ? kLeaseChecks : kHotChecks);
  for (const v1::StandbyState& one : along) {
    const auto known = claims_.find(one.site());
    const auto received =
        known == claims_.end()
            ? std::nullopt
            : peers_.received({known->second.claim.worker(), known->second.claim.incarnation()});
    if (received && *received + peers_.hot_patience() > now) {
      period = std::min<Duration>(period, *received + peers_.hot_patience() - now);
    }
  }
  return period;
}

// Sites without an owner go before requests that can wait.
void ClaimKeeper::see_to_sites() {
  std::vector<std::string> to_read;
  std::set<std::string> offered;
  {
    const Time now = std::chrono::steady_clock::now();
    const std::lock_guard lock(mutex_);
    if (leaving_ || !peers_.may_judge(now)) {
      return;
    }
    offered = offered_;
    for (const std::string& site : offered_) {
      if (owned_.count(site) != 0) {
        continue;
      }
      Claim& known = claims_[site];
      if (known.asked == Time{} || now - known.asked > kClaimReadInterval) {
        to_read.push_back(site);
      }
    }
  }
  claim_due_sites(offered);
  for (const std::string& site : to_read) {
    progress_.beat();
    read_claim(site);
  }
  if (!to_read.empty()) {
    claim_due_sites(offered);
  }
}

// Those for which this worker is a standby come first: they go on at once.
void ClaimKeeper::claim_due_sites(const std::set<std::string>& offered) {
  std::vector<std::string> in_order(offered.begin(), offered.end());
  {
    const std::lock_guard lock(mutex_);
    std::stable_partition(
        in_order.begin(), in_order.end(), [&](const std::string& site) { return stands_by(site); });
  }
  const Time now = std::chrono::steady_clock::now();
  for (const std::string& site : in_order) {
    progress_.beat();
    std::unique_lock lock(mutex_);
    // Includes sites claimed earlier in this loop.
    if (owned_.count(site) == 0 && is_due(site, claims_[site], now)) {
      lock.unlock();
      try_to_claim(site);
    }
  }
}

// Gives each worker that precedes this one half a lease to claim first.
bool ClaimKeeper::is_due(const std::string& site, Claim& known, Time now) const {
  if (known.asked == Time{} || returning_.count(site) != 0) {
    return false;  // it is not known yet if another worker has it
  }
  if (has_owner(site, known, now)) {
    known.ownerless = {};
    return false;
  }
  if (known.ownerless == Time{}) {
    known.ownerless = now;
  }
  const auto rank = rank_for(site, "", now);
  return rank && now - known.ownerless >= static_cast<Duration::rep>(*rank) * options_.lease / 2;
}

// REQUIRES: the mutex is held. As PeerWatch::rank().
std::optional<std::size_t> ClaimKeeper::rank_for(const std::string& site,
                                                 const std::string& owner,
                                                 Time now) const {
  const Candidate self{options_.worker,
                       owned_.size(),
                       options_.capacity,
                       stands_by(site),
                       condition_.shedding() > 0};
  return peers_.rank(self, site, owner, options_.all_sites, now);
}

bool ClaimKeeper::is_next(const std::string& site) const {
  const Time now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  const auto known = claims_.find(site);
  if (leaving_ || known == claims_.end() || known->second.claim.worker() == options_.worker ||
      known->second.claim.worker().empty() || owned_.count(site) != 0 || !peers_.may_judge(now) ||
      !has_owner(site, known->second, now)) {
    return false;
  }
  const auto rank = rank_for(site, known->second.claim.worker(), now);
  return rank && *rank == 0;
}

std::optional<double> ClaimKeeper::calmest() const {
  const std::lock_guard lock(mutex_);
  return peers_.calmest(std::chrono::steady_clock::now());
}

void ClaimKeeper::give_back(const std::string& site, std::uint64_t generation) {
  const std::lock_guard lock(mutex_);
  if (const auto owned = owned_.find(site); owned != owned_.end() && owned->second == generation) {
    withdraw(owned);
  }
}

void ClaimKeeper::withdraw(const std::string& site) {
  const std::lock_guard lock(mutex_);
  offered_.erase(site);
  if (const auto owned = owned_.find(site); owned != owned_.end()) {
    withdraw(owned);
  }
}

// REQUIRES: the mutex is held.
void ClaimKeeper::withdraw(std::map<std::string, std::uint64_t>::iterator owned) {
  offered_.erase(owned->first);
  returning_[owned->first] = owned->second;
  owned_.erase(owned);
  send_now_ = check_now_ = true;
  wake_.notify_one();
  send_.notify_one();
}

std::string ClaimKeeper::trouble() const {
  const std::lock_guard lock(mutex_);
  return peers_.yields(std::chrono::steady_clock::now())
             ? "another worker is called '" + options_.worker +
                   "' as well, and this one claims nothing: give each its own [cluster] name"
             : "";
}

std::vector<ClaimKeeper::Change> ClaimKeeper::take_changes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(changes_, {});
}

std::string ClaimKeeper::owner_of(const std::string& site) const {
  const std::lock_guard lock(mutex_);
  const auto found = claims_.find(site);
  return found == claims_.end() ? "" : found->second.claim.worker();
}

}  // namespace rayloc
