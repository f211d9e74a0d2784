// The part of ClaimKeeper that reads and writes the stream of claims.
#include <algorithm>
#include <limits>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "daemon/live/cluster/sealed_message.h"

namespace rayloc {

// After a disconnection the broker may have another store. False: its state is unavailable.
bool ClaimKeeper::see_to_streams() {
  if (broker_->connections() == connections_) {
    return true;
  }
  const std::uint64_t connections = broker_->connections();
  const auto claims = make_worker_streams(*broker_, options_.stream, options_.result_age);
  if (!claims) {
    return false;
  }
  connections_ = connections;
  const std::lock_guard lock(mutex_);
  for (auto& [site, claim] : claims_) {
    claim.asked = {};
    claim.sequence = claims->created == created_ ? claim.sequence : 0;
  }
  created_ = claims->created;
  to_restore_ = owned_;
  return true;
}

// Restores claims that a store has lost: other workers need the owners of the sites.
void ClaimKeeper::restore_claims() {
  for (auto one = to_restore_.begin(); one != to_restore_.end();) {
    const auto& [site, generation] = *one;
    progress_.beat();
    if (!read_claim(site)) {
      return;
    }
    std::unique_lock lock(mutex_);
    const auto owned = owned_.find(site);
    const bool is_lost =
        owned != owned_.end() && owned->second == generation && claims_[site].sequence == 0;
    lock.unlock();
    if (is_lost) {
      const auto sent = broker_->publish_behind(claim_subject(site), seal(claim_of(generation)), 0);
      if (!sent || !sent->is_last) {
        return;  // the next check shows which came first
      }
      note(site, sent->sequence, claim_of(generation));
    }
    one = to_restore_.erase(one);
  }
}

// Reads its record; returns true if the state is known.
bool ClaimKeeper::read_claim(const std::string& site) {
  const auto last = broker_->last_of(std::string(kClaimStream), claim_subject(site));
  if (!last) {
    return false;
  }
  v1::SiteClaim claim;
  if (*last) {
    if (!unseal((*last)->data, claim)) {
      claim.Clear();  // unreadable: it has no owner and is claimed after it
    }
    note(site, (*last)->sequence, claim);
  }
  const std::lock_guard lock(mutex_);
  claims_[site].sequence = *last ? claims_[site].sequence : 0;  // it may have been deleted
  claims_[site].asked = std::chrono::steady_clock::now();
  return true;
}

// Generation of the last result of a site; 0: there is none that is readable.
Expected<std::uint64_t> ClaimKeeper::results_generation(const std::string& site) const {
  const auto last = broker_->last_of(std::string(kOutputStream), output_subject(site));
  RAYLOC_TRY(last);
  v1::OutputRecord record;
  const bool is_readable = *last && unseal((*last)->data, record).has_value() &&
                           record.generation() < std::numeric_limits<std::uint64_t>::max();
  return is_readable ? record.generation() : 0;
}

// The claim must exceed the results (owner_log.h), which a forged or unreadable record does not
// show to a worker that has started after it. A standby has received the owner's records and saves
// the request, unless that record is the last one.
void ClaimKeeper::try_to_claim(const std::string& site) {
  if (!read_claim(site)) {
    return;
  }
  Claim known;
  bool follows_results = false;
  {
    const std::lock_guard lock(mutex_);
    known = claims_[site];
    const std::uint64_t stated = known.claim.generation();
    follows_results =
        known.sequence > 0 && (!stands_by(site) || stated == 0 || stated > known.highest);
    if (leaving_ || offered_.count(site) == 0 ||
        has_owner(site, known, std::chrono::steady_clock::now())) {
      return;
    }
  }
  const auto before_all = static_cast<std::uint64_t>(
      std::chrono::floor<std::chrono::milliseconds>(created_.time_since_epoch()).count());
  const Expected<std::uint64_t> results = follows_results ? results_generation(site) : 0;
  if (!results) {
    return;  // the next check reads it again
  }
  const v1::SiteClaim mine = claim_of(std::max({known.highest, before_all, *results}) + 1);
  const auto sent = broker_->publish_behind(claim_subject(site), seal(mine), known.sequence);
  if (!sent) {
    return;  // the next check shows the outcome
  }
  if (!sent->is_last) {
    read_claim(site);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    const Time now = std::chrono::steady_clock::now();
    owned_[site] = mine.generation();
    claims_[site] = {sent->sequence, mine, {}, now, now, mine.generation()};
    changes_.push_back({site, mine.generation(), options_.worker});
    send_now_ = true;
  }
  send_.notify_one();
}

// Processes them one after the other, for as long as the broker answers.
void ClaimKeeper::return_sites() {
  std::map<std::string, std::uint64_t> returning;
  {
    const std::lock_guard lock(mutex_);
    returning = returning_;
  }
  for (const auto& [site, generation] : returning) {
    progress_.beat();
    if (!return_site(site, generation)) {
      return;
    }
    const std::lock_guard lock(mutex_);
    if (const auto known = claims_.find(site); known == claims_.end() ||
                                               known->second.claim.worker() != options_.worker ||
                                               known->second.claim.generation() != generation) {
      returning_.erase(site);
    }
  }
}

// The record states that the site has no owner: the best of the others
// need not wait for a lease. False: the broker does not answer.
bool ClaimKeeper::return_site(const std::string& site, std::uint64_t generation) {
  std::uint64_t sequence = 0;
  {
    const std::lock_guard lock(mutex_);
    const Claim& known = claims_[site];
    if (known.claim.worker() != options_.worker || known.claim.generation() != generation) {
      return true;  // another worker has it
    }
    sequence = known.sequence;
  }
  v1::SiteClaim no_owner;
  no_owner.set_generation(generation);
  const auto sent = broker_->publish_behind(claim_subject(site), seal(no_owner), sequence);
  if (sent && sent->is_last) {
    note(site, sent->sequence, no_owner);
    return true;
  }
  return sent && read_claim(site);
}

}  // namespace rayloc
