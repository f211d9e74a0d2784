// PeerWatch: tracks live workers and the sites that each reports. Liveness is judged
// by the local clock alone, and only by a worker that receives its own messages.
//
// Thread safety: one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "daemon/live/cluster/ownership/claim_rule.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class PeerWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // Reports of a worker in a lease. Each is sent an interval after the last one, plus a moment.
  static constexpr int kReports = 4;
  // Start of a worker: its name and incarnation.
  using Start = std::pair<std::string, std::uint64_t>;

  PeerWatch(Start self, Duration lease) : self_(std::move(self)), lease_(lease) {}

  // `own_sites`: number of our sites.
  void take(const v1::WorkerState& state, std::size_t own_sites, Time now);

  bool may_judge(Time now) const;
  // Returns true if one of our own messages arrived within that duration.
  bool receives_itself(Time now, Duration within) const {
    return received_itself_ != Time{} && now - received_itself_ < within;
  }
  // Arrival of the last message of a worker; nothing: it is not remembered.
  std::optional<Time> received(const Start& start) const;
  // Patience with the owner of a site: a lease, or hot_patience() for its hot standby, while our
  // own reports arrive: the silence is then not the broker's.
  Duration patience(bool stands_by, Time now) const;
  // Two reports of the owner may be lost: the next one has half an interval to arrive.
  Duration hot_patience() const;
  // Its name, and since when it has the claim.
  struct Owner {
    Start start;
    Time since{};
  };
  // Returns true if the owner was received within `patience` and has that site:
  // it reported so in the last few leases, or got it within them.
  bool has(const Owner& owner, const std::string& site, Duration patience, Time now) const;
  // Returns true if another live worker reports that it has the site.
  bool any_peer_has(const std::string& site, Time now) const;
  // Number of other live workers that precede `self` for that
  // site, without `but`; nothing where it takes no more sites.
  std::optional<std::size_t> rank(const Candidate& self,
                                  const std::string& site,
                                  const std::string& but,
                                  std::size_t all_sites,
                                  Time now) const;
  // Least load of the other live workers that leave
  // nothing out and take more sites; nothing: none.
  std::optional<double> calmest(Time now) const;
  // Returns true if another worker of our name is alive that has priority.
  bool yields(Time now) const;
  std::size_t size() const { return peers_.size(); }

 private:
  struct Peer {
    Candidate candidate;
    double load = 0.0;
    bool leaving = false;
    Time received;
    std::set<std::string> stands_by;    // sites for which it is a standby
    std::map<std::string, Time> sites;  // time of its last report of each site
  };

  bool lives(const Peer& peer, Time now) const { return now - peer.received < lease_; }
  bool names(const Peer& peer, const std::string& site, Time now) const;
  void forget(Time now);

  const Start self_;
  const Duration lease_;
  std::map<Start, Peer> peers_;
  Time receives_itself_since_{};  // zero: it does not
  Time received_itself_{};
  Time yielded_{};  // last message of that other worker; zero: none
};

}  // namespace rayloc
