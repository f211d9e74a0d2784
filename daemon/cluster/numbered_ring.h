// NumberedRing: the batches of one site that a capture node owes to the cluster: numbered, kept
// until somebody has consumed them (not until the broker has acknowledged them: a broker may lose
// what it acknowledged), sent again when asked for, and replaced by a mark of a gap when the broker
// was away for too long: what is heard now never waits for what was heard then.
//
// Law, in datagrams of each access point, at every instant: added = live + marked + waiting.
//
// It reads no clock. Thread safety: one thread at a time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cluster/batch.h"

namespace rayloc {

// Datagrams of a batch by access point.
std::map<std::string, std::uint64_t> counts_of(const Batch& batch);

class NumberedRing {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Counts = std::map<std::string, std::uint64_t>;  // datagrams by access point

  struct Limits {
    // What has waited so long for the broker gives way to a mark.
    Duration stale = std::chrono::seconds(2);
    // What was acknowledged is kept so long, and so much of it, where nobody consumes it.
    Duration keep = std::chrono::seconds(30);
    std::size_t keep_bytes = std::size_t{64} << 20U;
    // On their way, and not acknowledged.
    std::size_t window_bytes = std::size_t{8} << 20U;
    // What has not been acknowledged by then is sent again.
    Duration patience = std::chrono::seconds(1);
  };

  NumberedRing(std::uint64_t epoch, Limits limits) : epoch_(epoch), limits_(limits) {}

  // Gives it the next number. Its epoch, number, gaps and oldest_kept are the ring's matter.
  void add(Batch batch, Time now);
  // Marks what has waited for too long and forgets what has been kept for long enough.
  void tend(Time now);

  // Those that have waited for too long, since the last call.
  std::vector<Batch> take_left_out() { return std::exchange(left_out_, {}); }

  struct Ready {
    std::uint64_t number = 0;
    unsigned repeat = 0;  // how often somebody has asked for it
    std::shared_ptr<const std::string> bytes;
  };
  // What is to be sent now, and is on its way from then on; nothing while the window is full.
  std::optional<Ready> next(Time now);
  // Whether there is something that was not sent yet, and room for it.
  bool has_next() const {
    return !asked_.empty() || (!unsent_.empty() && window_ < limits_.window_bytes);
  }
  // That one could not be given to the broker: it waits for the next try.
  void not_sent(std::uint64_t number);
  void acknowledged(std::uint64_t number);
  // Nobody will ask for that one and those before it.
  void consumed(std::uint64_t number);
  // Somebody lacks [from, to]: what is still kept is sent again, of the rest a mark is.
  void ask(std::uint64_t from, std::uint64_t to);

  // Whether anything has not been acknowledged yet.
  bool owes() const { return !marks_.empty() || !unsent_.empty() || !on_their_way_.empty(); }

  struct Counters {
    Counts added, live, marked, waiting;
    std::uint64_t batches = 0;         // numbered
    std::uint64_t sent = 0;            // messages given to the broker
    std::uint64_t repeated = 0;        // among them: nobody had acknowledged them
    std::uint64_t asked_for = 0;       // among them: somebody lacked them
    std::uint64_t marked_batches = 0;  // that marks have taken the place of
    std::uint64_t unacknowledged = 0;  // batches on their way or waiting for it
    std::uint64_t kept = 0;            // batches that can be sent again
    std::uint64_t kept_bytes = 0;
  };
  Counters counters() const;

 private:
  enum class State : std::uint8_t { kWaiting, kOnItsWay, kAcknowledged };
  struct Entry {
    State state = State::kWaiting;
    Time added;
    Time sent;
    unsigned repeat = 0;
    Batch batch;                               // until it is first sent
    std::shared_ptr<const std::string> bytes;  // from then on
    Counts counts;
    std::vector<BatchGap> gaps;  // that `bytes` tell of
  };
  using Entries = std::map<std::uint64_t, Entry>;
  // What is known of a batch that is no longer kept.
  struct Remembered {
    Counts counts;
    std::vector<BatchGap> gaps;
  };

  Ready send(Entries::iterator entry, Time now);
  void forget(Entries::iterator entry);
  void mark(std::uint64_t number, Counts& of, Remembered batch, const std::string& reason);
  void add_mark(BatchGap gap);
  bool is_marked(std::uint64_t number) const;

  const std::uint64_t epoch_;
  const Limits limits_;
  std::uint64_t last_ = 0;  // number
  Entries entries_;         // by number
  std::map<std::uint64_t, Remembered> remembered_;
  std::set<std::uint64_t> unsent_;  // kWaiting
  std::set<std::pair<Time, std::uint64_t>> on_their_way_;
  std::set<std::uint64_t> asked_;  // to be sent again
  std::vector<BatchGap> marks_;    // for the next batch; ascending
  std::vector<Batch> left_out_;
  std::size_t window_ = 0;      // bytes of kOnItsWay
  std::size_t kept_bytes_ = 0;  // of all `bytes`
  Counters counters_;
};

}  // namespace rayloc
