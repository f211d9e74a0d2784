#include "daemon/live/cluster/ownership/peer_watch.h"

#include <algorithm>
#include <vector>

namespace rayloc {
namespace {

// In leases. Period in which an owner need not name a site that it has: messages may be lost.
constexpr int kUnnamed = 3;
// Period in which a silent worker is remembered.
constexpr int kRemembered = 10;
// In halves of an interval between reports. A hot standby waits for the report after the lost ones,
// and half an interval longer. One of its own reports must have arrived an interval or more after
// the last one of the owner.
constexpr int kHotLost = 2;
constexpr int kLeaseHalves = 2 * PeerWatch::kReports;
constexpr int kHotHalves = 2 * (kHotLost + 1) + 1;
constexpr int kHotOwnHalves = kHotHalves - 2;
constexpr double kPermille = 1e-3;
constexpr int kYield = 2;  // after the last message of another worker of our name

}  // namespace

void PeerWatch::take(const v1::WorkerState& state, std::size_t own_sites, Time now) {
  const Start start(state.worker(), state.incarnation());
  if (start == self_) {
    if (now - received_itself_ > lease_) {
      receives_itself_since_ = now;
    }
    received_itself_ = now;
  } else if (start.first == self_.first) {
    // The one with sites keeps the name; on a tie the higher incarnation. Both decide the same.
    const bool has_some = state.sites_size() > 0;
    const bool has_more = has_some && own_sites == 0;
    const bool has_as_much = has_some == (own_sites > 0);
    yielded_ = has_more || (has_as_much && start.second > self_.second) ? now : yielded_;
  }
  Peer& peer = peers_[start];
  peer.candidate = {state.worker(), static_cast<std::size_t>(state.sites_size()), state.capacity()};
  peer.candidate.is_behind = state.shedding() > 0;
  peer.load = state.load_permille() * kPermille;
  peer.leaving = state.leaving();
  peer.received = now;
  peer.stands_by.clear();
  for (const v1::StandbyState& one : state.stands_by()) {
    peer.stands_by.insert(one.site());
  }
  for (const std::string& site : state.sites()) {
    peer.sites[site] = now;
  }
  std::erase_if(peer.sites,
                [&](const auto& site) { return now - site.second >= kUnnamed * lease_; });
  forget(now);
}

void PeerWatch::forget(Time now) {
  std::erase_if(peers_,
                [&](const auto& one) { return now - one.second.received > kRemembered * lease_; });
}

bool PeerWatch::may_judge(Time now) const {
  return receives_itself_since_ != Time{} && now - received_itself_ < lease_ &&
         now - receives_itself_since_ >= lease_;
}

std::optional<PeerWatch::Time> PeerWatch::received(const Start& start) const {
  const auto peer = peers_.find(start);
  return peer == peers_.end() ? std::nullopt : std::optional(peer->second.received);
}

Duration PeerWatch::hot_patience() const { return lease_ * kHotHalves / kLeaseHalves; }

Duration PeerWatch::patience(bool stands_by, Time now) const {
  const bool is_hot = stands_by && receives_itself(now, lease_ * kHotOwnHalves / kLeaseHalves);
  return is_hot ? hot_patience() : lease_;
}

bool PeerWatch::names(const Peer& peer, const std::string& site, Time now) const {
  const auto named = peer.sites.find(site);
  return named != peer.sites.end() && now - named->second < kUnnamed * lease_;
}

bool PeerWatch::has(const Owner& owner,
                    const std::string& site,
                    Duration patience,
                    Time now) const {
  const auto peer = peers_.find(owner.start);
  return peer != peers_.end() && now - peer->second.received < patience &&
         (now - owner.since < kUnnamed * lease_ || names(peer->second, site, now));
}

bool PeerWatch::any_peer_has(const std::string& site, Time now) const {
  return std::any_of(peers_.begin(), peers_.end(), [&](const auto& one) {
    return one.first != self_ && lives(one.second, now) && names(one.second, site, now);
  });
}

std::optional<std::size_t> PeerWatch::rank(const Candidate& self,
                                           const std::string& site,
                                           const std::string& but,
                                           std::size_t all_sites,
                                           Time now) const {
  if (is_full(self)) {
    return std::nullopt;
  }
  std::vector<Candidate> all = {self};
  for (const auto& [start, peer] : peers_) {
    if (start.first != self_.first && start.first != but && !peer.leaving && lives(peer, now)) {
      all.push_back(peer.candidate);
      all.back().stands_by = peer.stands_by.count(site) != 0;
    }
  }
  return rank_of(self.worker, site, all_sites, all);
}

std::optional<double> PeerWatch::calmest(Time now) const {
  std::optional<double> least;
  for (const auto& [start, peer] : peers_) {
    if (start.first != self_.first && lives(peer, now) && !peer.leaving &&
        !peer.candidate.is_behind && !is_full(peer.candidate) && peer.load < least.value_or(1.0)) {
      least = peer.load;
    }
  }
  return least;
}

bool PeerWatch::yields(Time now) const {
  return yielded_ != Time{} && now - yielded_ < kYield * lease_;
}

}  // namespace rayloc
