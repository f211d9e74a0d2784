// StandbyAudit: compares what a worker that stands by has computed with what the owner of the site
// has published, record by record, and says whether it could go on in the owner's place.
//
// A window is what one record of the owner holds: results of instants from the `done` of the record
// before it up to its own. What the owner carries for a successor is compared as well: where tracks
// have other numbers, or stays in zones are others, subscribers would hear two stories.
//
// Thread safety: one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "daemon/cluster/ownership/compared_item.h"
#include "daemon/cluster/ownership/out_items.h"
#include "daemon/pipeline/warm/carried.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class StandbyAudit {
 public:
  struct Options {
    std::uint64_t generation = 0;  // of the owner
    Likeness likeness = Likeness::kSameBytes;
    Duration most_behind = std::chrono::seconds(100);  // a record of the owner waits to be computed
  };

  explicit StandbyAudit(Options options) : options_(options) {}

  // A word of the owner, as the stream of results tells it.
  void hear(v1::OutputRecord record);
  // Compares what both know, and takes what the owner has said out of `own`. `states`: what was
  // found that a successor is to be told.
  void compare(OutItems& own, const std::deque<Carried>& states);
  // Up to where the owner has said everything, as far as that was compared.
  Timestamp done() const { return done_; }

  struct Counters {
    std::uint64_t windows = 0;       // that were compared
    std::uint64_t results = 0;       // of the owner in them
    std::uint64_t differing = 0;     // windows
    std::uint64_t not_compared = 0;  // windows of which no record came
  };
  const Counters& counters() const { return counters_; }
  // The first window that differs, in words; empty: none does.
  const std::string& first_difference() const { return first_difference_; }
  // Why it cannot go on in the owner's place; empty: it can.
  const std::string& trouble() const { return trouble_; }

 private:
  struct Window {
    v1::SiteOutput output;
    bool is_whole = false;  // the record before it was heard
    std::chrono::steady_clock::time_point heard;
  };

  void compare_results(const Window& window, const std::vector<v1::OutputItem>& own);
  void compare_state(const v1::Carried& theirs, const std::deque<Carried>& states);

  const Options options_;
  std::uint64_t number_ = 0;  // of the last record
  std::deque<Window> waiting_;
  Timestamp done_ = Timestamp::min();
  Counters counters_;
  int others_ = 0;  // states in a row that name others
  std::string first_difference_;
  std::string trouble_;
};

}  // namespace rayloc
