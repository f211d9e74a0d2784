// StandbyAudit: compares the results of a standby with the published results of the owner of
// the site, record by record, and determines whether it could continue in the owner's place.
//
// A window is the content of one record of the owner: results for instants from the `done`
// of the previous record up to its own. The carried state is compared as well: with other
// track numbers, or other stays in zones, subscribers would receive contradictory results.
//
// Thread safety: one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "daemon/live/cluster/ownership/compared_item.h"
#include "daemon/live/cluster/ownership/out_items.h"
#include "daemon/pipeline/warm/carried.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class StandbyAudit {
 public:
  struct Options {
    std::uint64_t generation = 0;  // of the owner
    Likeness likeness = Likeness::kSameBytes;
    Duration most_behind = std::chrono::seconds(100);  // maximum wait of a record of the owner
  };

  explicit StandbyAudit(Options options) : options_(options) {}

  // Takes a record of the owner, from the stream of results.
  void receive(v1::OutputRecord record);
  // Compares the results that both have, and removes from `own` what the
  // owner has published. `states`: the computed states for a successor.
  void compare(OutItems& own, const std::deque<Carried>& states);
  // End of the owner's published results, as far as they were compared.
  Timestamp done() const { return done_; }

  struct Counters {
    std::uint64_t windows = 0;       // compared
    std::uint64_t results = 0;       // results of the owner in them
    std::uint64_t differing = 0;     // windows
    std::uint64_t not_compared = 0;  // windows whose record is missing
  };
  const Counters& counters() const { return counters_; }
  // The first window that differs, as text; empty: none does.
  const std::string& first_difference() const { return first_difference_; }
  // Reason why it cannot continue in the owner's place; empty: it can.
  const std::string& trouble() const { return trouble_; }

 private:
  struct Window {
    v1::SiteOutput output;
    bool is_whole = false;  // the record before it was received
    std::chrono::steady_clock::time_point received;
  };

  void compare_results(const Window& window, const std::vector<v1::OutputItem>& own);
  void compare_state(const v1::Carried& theirs, const std::deque<Carried>& states);

  const Options options_;
  std::uint64_t number_ = 0;  // of the last record
  std::deque<Window> waiting_;
  Timestamp done_ = Timestamp::min();
  Counters counters_;
  int others_ = 0;  // consecutive states that differ
  std::string first_difference_;
  std::string trouble_;
};

}  // namespace rayloc
