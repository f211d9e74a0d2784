// NumberedRing: the batches of one site that a capture node owes to the cluster:
// numbered, kept until they are consumed (not until the broker has acknowledged them:
// a broker may lose what it acknowledged), sent again on request, and replaced by a
// gap mark when the broker was away for too long: new data never wait for old data.
//
// Invariant, in datagrams of each access point, at all times: added = live + marked + waiting.
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

#include "daemon/live/cluster/batch.h"

namespace rayloc {

// Datagrams of a batch by access point.
std::map<std::string, std::uint64_t> counts_of(const Batch& batch);

class NumberedRing {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Counts = std::map<std::string, std::uint64_t>;  // datagrams by access point

  struct Limits {
    // A batch that has waited so long for the broker is replaced by a mark.
    Duration stale = std::chrono::seconds(2);
    // Retention of acknowledged batches that are not consumed, in time and in size.
    Duration keep = std::chrono::seconds(30);
    std::size_t keep_bytes = std::size_t{64} << 20U;
    // Batches in transit, not yet acknowledged.
    std::size_t window_bytes = std::size_t{8} << 20U;
    // A batch that has not been acknowledged by then is sent again.
    Duration patience = std::chrono::seconds(1);
  };

  NumberedRing(std::uint64_t epoch, Limits limits) : epoch_(epoch), limits_(limits) {}

  // Assigns the next number. The ring sets its epoch, number, gaps and oldest_kept.
  void add(Batch batch, Time now);
  // Marks batches that have waited too long and drops those that were kept long enough.
  void tend(Time now);

  // Batches that have waited too long, since the last call.
  std::vector<Batch> take_left_out() { return std::exchange(left_out_, {}); }

  struct Ready {
    std::uint64_t number = 0;
    unsigned repeat = 0;  // number of requests for it
    std::shared_ptr<const std::string> bytes;
  };
  // Next batch to send, in transit from then on; nothing while the window is full.
  std::optional<Ready> next(Time now);
  // Returns true if a batch was not sent yet and the window has room for it.
  bool has_next() const {
    return !asked_.empty() || (!unsent_.empty() && window_ < limits_.window_bytes);
  }
  // That batch could not be passed to the broker: it waits for the next try.
  void not_sent(std::uint64_t number);
  void acknowledged(std::uint64_t number);
  // That batch and its predecessors will not be requested again.
  void consumed(std::uint64_t number);
  // A reader lacks [from, to]: batches still kept are sent again, the others are marked.
  void ask(std::uint64_t from, std::uint64_t to);

  // Returns true if anything has not been acknowledged yet.
  bool owes() const { return !marks_.empty() || !unsent_.empty() || !in_flight_.empty(); }

  struct Counters {
    Counts added, live, marked, waiting;
    std::uint64_t batches = 0;         // numbered
    std::uint64_t sent = 0;            // messages passed to the broker
    std::uint64_t repeated = 0;        // among them: repeated without an acknowledgement
    std::uint64_t asked_for = 0;       // among them: requested by a reader
    std::uint64_t marked_batches = 0;  // replaced by marks
    std::uint64_t unacknowledged = 0;  // batches in transit or waiting for it
    std::uint64_t kept = 0;            // batches that can be sent again
    std::uint64_t kept_bytes = 0;
  };
  Counters counters() const;

 private:
  enum class State : std::uint8_t { kWaiting, kInFlight, kAcknowledged };
  struct Entry {
    State state = State::kWaiting;
    Time added;
    Time sent;
    unsigned repeat = 0;
    Batch batch;                               // until it is first sent
    std::shared_ptr<const std::string> bytes;  // from then on
    Counts counts;
    std::vector<BatchGap> gaps;  // described in `bytes`
  };
  using Entries = std::map<std::uint64_t, Entry>;
  // Data about a batch that is no longer kept.
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
  std::set<std::pair<Time, std::uint64_t>> in_flight_;
  std::set<std::uint64_t> asked_;  // to be sent again
  std::vector<BatchGap> marks_;    // for the next batch; ascending
  std::vector<Batch> left_out_;
  std::size_t window_ = 0;      // bytes of kInFlight
  std::size_t kept_bytes_ = 0;  // of all `bytes`
  Counters counters_;
};

}  // namespace rayloc
