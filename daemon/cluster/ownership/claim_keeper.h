// ClaimKeeper: which sites this worker owns. Workers say several times within a lease that they are
// alive; a site whose owner is not heard for a lease belongs to the best of the others
// (claim_rule.h), who claims it by compare-and-set.
//
// A claim is advice, which keeps two from computing the same; what is said twice is refused by the
// stream of results (owner_log.h). So nobody gives up a site because the broker is away: nobody can
// take it over then. Who lives is judged by peer_watch.h.
//
// Generations begin with the instant at which the stream of claims was made, in milliseconds: of
// one that was made anew they are higher than all before, also where nobody remembers those.
//
// Thread safety: any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "daemon/cluster/broker.h"
#include "daemon/cluster/ownership/claim_streams.h"
#include "daemon/cluster/ownership/peer_watch.h"
#include "daemon/pipeline/stage_progress.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class ClaimKeeper {
 public:
  struct Options {
    std::string worker;
    std::uint64_t incarnation = 0;  // of this start
    Duration lease = std::chrono::seconds(2);
    std::size_t capacity = 0;           // sites at most; 0: any number
    std::size_t all_sites = 0;          // that there are, as far as this worker knows
    StreamOptions stream;               // of claims, that is made where there is none
    std::chrono::seconds result_age{};  // of the stream of results, ten minutes at least
  };

  static Expected<std::unique_ptr<ClaimKeeper>> open(std::shared_ptr<Broker> broker,
                                                     Options options);
  ~ClaimKeeper();
  ClaimKeeper(const ClaimKeeper&) = delete;
  ClaimKeeper& operator=(const ClaimKeeper&) = delete;

  void start();
  void finish();

  // From now on it may be claimed: all is prepared.
  void offer(const std::string& site);
  // It is not to be claimed any more, and given back if it is still that claim that is owned: until
  // the broker has taken that, or somebody else has it.
  void give_back(const std::string& site, std::uint64_t generation);
  // The same, whatever claim is owned.
  void withdraw(const std::string& site);
  // Takes no more, whatever is offered; says so.
  void leave();
  bool is_leaving() const { return leaving_; }
  // Whether another one who lives has the site, and this one would claim it first.
  bool is_next(const std::string& site) const;
  // How this worker is, as it says of itself: the sites for which it computes along, for which it
  // is asked first; its load, and of how many sites it leaves something out.
  void set_condition(const v1::WorkerState& condition) {
    const std::lock_guard lock(mutex_);
    condition_ = condition;
  }
  // The least load of another worker who has room; nothing: nobody has.
  std::optional<double> calmest() const;

  struct Change {
    std::string site;
    std::uint64_t generation = 0;  // of the claim; 0: it is another worker's
    std::string owner;             // whose
  };
  // What has changed since the last call.
  std::vector<Change> take_changes();
  // Who has a site that this one does not have; empty: nobody, as far as is known.
  std::string owner_of(const std::string& site) const;
  // Why nothing can be claimed; empty: it can.
  std::string trouble() const;
  const StageProgress& progress() const { return progress_; }
  const StageProgress& speaking() const { return speaking_; }

 private:
  using Time = std::chrono::steady_clock::time_point;
  // [s], chosen: a worker that offers a removed site has heard by then that it is no more.
  static constexpr std::chrono::seconds kRemovedFor{30};
  struct Claim {
    std::uint64_t sequence = 0;  // of its record; 0: there is none
    v1::SiteClaim claim;
    Time ownerless{};  // since when nobody has it, by our clock; zero: somebody has
    Time noted{};      // when we learned of it
    Time asked{};
  };

  ClaimKeeper(std::shared_ptr<Broker> broker, Options options);
  void take_state(const BrokerMessage& message);
  void take_claim(const BrokerMessage& message);
  void speak();
  v1::WorkerState state() const;
  void run();
  bool see_to_streams();
  void withdraw(std::map<std::string, std::uint64_t>::iterator owned);
  void return_sites();
  bool return_site(const std::string& site, std::uint64_t generation);
  void restore_claims();
  void see_to_sites(Time now);
  bool has_owner(const std::string& site, const Claim& known, Time now) const;
  bool is_due(const std::string& site, Claim& known, Time now) const;
  std::optional<std::size_t> rank_for(const std::string& site,
                                      const std::string& owner,
                                      Time now) const;
  v1::SiteClaim claim_of(std::uint64_t generation) const;
  void try_to_claim(const std::string& site);
  bool look(const std::string& site);
  void note(const std::string& site, std::uint64_t sequence, const v1::SiteClaim& claim);

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  StageProgress progress_;
  StageProgress speaking_;
  std::atomic<bool> leaving_{false};
  // Used by the thread alone: when the stream was last seen to, when it was made, and which owned
  // sites may have no claim in it.
  std::uint64_t connections_ = 0;
  Timestamp created_{};
  std::map<std::string, std::uint64_t> to_restore_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable speak_;
  std::set<std::string> offered_;                   // guarded by mutex_
  std::map<std::string, std::uint64_t> owned_;      // guarded by mutex_; generation by site
  std::map<std::string, std::uint64_t> returning_;  // guarded by mutex_; the same, to be given back
  std::map<std::string, Claim> claims_;             // guarded by mutex_; by site
  PeerWatch peers_;                                 // guarded by mutex_
  std::vector<Change> changes_;                     // guarded by mutex_
  v1::WorkerState condition_;                       // guarded by mutex_; what is told of it
  bool finishing_ = false;                          // guarded by mutex_
  bool say_now_ = false;                            // guarded by mutex_
  bool look_now_ = false;                           // guarded by mutex_
  std::unique_ptr<Broker::Subscription> states_;    // these end before what they look at
  std::unique_ptr<Broker::Subscription> claimed_;
  std::unique_ptr<Broker::Subscription> drains_;
  std::thread speaker_;
  std::thread thread_;
};

}  // namespace rayloc
