// ClaimKeeper: determines which sites this worker owns. Workers report several times
// within a lease that they are alive; a site whose owner is silent for a lease goes
// to the best of the others (claim_rule.h), which claims it by compare-and-set.
//
// A claim is advisory and keeps two workers from computing the same; duplicate results are
// refused by the stream of results (owner_log.h). So no worker gives up a site because the
// broker is away: no other can take it over then. Liveness is judged by peer_watch.h.
//
// A hot standby claims after seven eighths of a lease, when three reports of the owner are missing,
// and no longer after the whole. That is as safe: the result of an owner that lives is refused, as
// after a lease.
//
// Generations begin with the creation time of the stream of claims, in milliseconds: in a stream
// that was recreated they exceed all earlier ones, even where no record of those remains. A claim
// exceeds the generation of the last result as well: a forged claim may be lower or far higher.
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

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/ownership/claim_streams.h"
#include "daemon/live/cluster/ownership/peer_watch.h"
#include "daemon/pipeline/stage_progress.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class ClaimKeeper {
 public:
  struct Options {
    std::string worker;
    std::uint64_t incarnation = 0;  // of this start
    Duration lease = std::chrono::seconds(2);
    std::size_t capacity = 0;           // maximum number of sites; 0: any number
    std::size_t all_sites = 0;          // known to this worker, in total
    StreamOptions stream;               // of claims, created where it does not exist
    std::chrono::seconds result_age{};  // retention of the stream of results, ten minutes at least
  };

  static Expected<std::unique_ptr<ClaimKeeper>> open(std::shared_ptr<Broker> broker,
                                                     Options options);
  ~ClaimKeeper();
  ClaimKeeper(const ClaimKeeper&) = delete;
  ClaimKeeper& operator=(const ClaimKeeper&) = delete;

  void start();
  void finish();

  // From now on the site may be claimed: all is prepared.
  void offer(const std::string& site);
  // The site is not to be claimed any more, and is given back if that claim is
  // still owned: until the broker has stored that, or another worker has it.
  void give_back(const std::string& site, std::uint64_t generation);
  // Gives the site back, whatever claim is owned.
  void withdraw(const std::string& site);
  // Takes no more sites, whatever is offered; reports so.
  void leave();
  bool is_leaving() const { return leaving_; }
  // Returns true if another live worker has the site, and this one would be the first to claim it.
  bool is_next(const std::string& site) const;
  // Condition that this worker reports: the sites for which it is a standby, and therefore
  // first to claim; its load, and the number of its sites for which it leaves data out.
  void set_condition(const v1::WorkerState& condition) {
    const std::lock_guard lock(mutex_);
    condition_ = condition;
  }
  // Returns the least load of the other workers that have capacity; nothing: none has.
  std::optional<double> calmest() const;

  struct Change {
    std::string site;
    std::uint64_t generation = 0;  // of the claim; 0: another worker's claim
    std::string owner;             // name of the owner
  };
  // Returns the changes since the last call.
  std::vector<Change> take_changes();
  // Owner of a site that this worker does not have; empty: none, as far as known.
  std::string owner_of(const std::string& site) const;
  // Reason why nothing can be claimed; empty: claims are possible.
  std::string trouble() const;
  const StageProgress& progress() const { return progress_; }
  const StageProgress& sending() const { return sending_; }

 private:
  using Time = std::chrono::steady_clock::time_point;
  // [s], chosen: by then a worker that offers a removed site has received the removal.
  static constexpr std::chrono::seconds kRemovedFor{30};
  struct Claim {
    std::uint64_t sequence = 0;  // of its record; 0: there is none
    v1::SiteClaim claim;
    Time ownerless{};  // start of the period without an owner, by our clock; zero: has one
    Time noted{};      // when we received it
    Time asked{};
    std::uint64_t highest = 0;  // generation of its received claims, without forged ones
  };

  ClaimKeeper(std::shared_ptr<Broker> broker, Options options);
  void take_state(const BrokerMessage& message);
  void take_claim(const BrokerMessage& message);
  void send_state();
  v1::WorkerState state() const;
  void run();
  bool see_to_streams();
  void withdraw(std::map<std::string, std::uint64_t>::iterator owned);
  void return_sites();
  bool return_site(const std::string& site, std::uint64_t generation);
  void restore_claims();
  void see_to_sites();
  Duration check_period(Time now) const;
  void claim_due_sites(const std::set<std::string>& offered);
  bool stands_by(const std::string& site) const;
  bool has_owner(const std::string& site, const Claim& known, Time now) const;
  bool is_due(const std::string& site, Claim& known, Time now) const;
  std::optional<std::size_t> rank_for(const std::string& site,
                                      const std::string& owner,
                                      Time now) const;
  v1::SiteClaim claim_of(std::uint64_t generation) const;
  void try_to_claim(const std::string& site);
  Expected<std::uint64_t> results_generation(const std::string& site) const;
  bool read_claim(const std::string& site);
  void note(const std::string& site, std::uint64_t sequence, const v1::SiteClaim& claim);

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  StageProgress progress_;
  StageProgress sending_;
  std::atomic<bool> leaving_{false};
  // Used by the thread alone: connections at the last check of the streams,
  // creation time of the stream, and owned sites whose claims may be missing in it.
  std::uint64_t connections_ = 0;
  Timestamp created_{};
  std::map<std::string, std::uint64_t> to_restore_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable send_;
  std::set<std::string> offered_;                   // guarded by mutex_
  std::map<std::string, std::uint64_t> owned_;      // guarded by mutex_; generation by site
  std::map<std::string, std::uint64_t> returning_;  // guarded by mutex_; the same, to be given back
  std::map<std::string, Claim> claims_;             // guarded by mutex_; by site
  PeerWatch peers_;                                 // guarded by mutex_
  std::vector<Change> changes_;                     // guarded by mutex_
  v1::WorkerState condition_;                       // guarded by mutex_; as reported
  bool finishing_ = false;                          // guarded by mutex_
  bool send_now_ = false;                           // guarded by mutex_
  bool check_now_ = false;                          // guarded by mutex_
  std::unique_ptr<Broker::Subscription> states_;    // these end before the members they use
  std::unique_ptr<Broker::Subscription> claimed_;
  std::unique_ptr<Broker::Subscription> drains_;
  std::thread sender_;
  std::thread thread_;
};

}  // namespace rayloc
