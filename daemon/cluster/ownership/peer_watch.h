// PeerWatch: who of the workers lives, and what each says that it has. Lives are judged by the own
// clock alone, and by nobody who does not hear itself.
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

#include "daemon/cluster/ownership/claim_rule.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class PeerWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // A start of a worker: its name and incarnation.
  using Start = std::pair<std::string, std::uint64_t>;

  PeerWatch(Start self, Duration lease) : self_(std::move(self)), lease_(lease) {}

  // `own_sites`: how many we have.
  void take(const v1::WorkerState& state, std::size_t own_sites, Time now);

  bool may_judge(Time now) const;
  // Whether it lives and has that site: it said so in the last few leases, or got it in them
  // (`since`).
  bool has(const Start& start, const std::string& site, Time since, Time now) const;
  // Whether somebody else who lives says that it has it.
  bool anybody_has(const std::string& site, Time now) const;
  // How many of the others who live come before `self` for that site, `but` left out; nothing where
  // it takes no more.
  std::optional<std::size_t> rank(const Candidate& self,
                                  const std::string& site,
                                  const std::string& but,
                                  std::size_t all_sites,
                                  Time now) const;
  // The least load of the others who live, leave nothing out and take more sites; nothing: there is
  // none.
  std::optional<double> calmest(Time now) const;
  // Whether another worker of our name lives to whom we leave it.
  bool yields(Time now) const;
  std::size_t size() const { return peers_.size(); }

 private:
  struct Peer {
    Candidate candidate;
    double load = 0.0;
    bool leaving = false;
    Time heard;
    std::set<std::string> stands_by;    // sites for which it computes along
    std::map<std::string, Time> sites;  // when it last said that it has them
  };

  bool lives(const Peer& peer, Time now) const { return now - peer.heard < lease_; }
  void forget(Time now);

  const Start self_;
  const Duration lease_;
  std::map<Start, Peer> peers_;
  Time hears_itself_since_{};  // zero: it does not
  Time heard_itself_{};
  Time yielded_{};  // when that other one was heard last; zero: never
};

}  // namespace rayloc
