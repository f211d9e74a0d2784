// OutItems: results in the order of the stream of results, which is a function
// of the results alone: those of one instant together, by target and kind.
//
// Thread safety: one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "daemon/messages/location.h"
#include "daemon/messages/target_event.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class OutItems {
 public:
  using Item = std::variant<Location, TrackEvent, ZoneEvent>;

  explicit OutItems(Timestamp done) : done_(done) {}

  void add(Item&& item);
  // All results before `time` are complete; returns false if that was known.
  bool advance(Timestamp time);
  // End of the complete results; whole microseconds, as in records.
  Timestamp done() const { return done_; }

  // Number of results at instants before done().
  std::size_t ready() const { return ready_.size(); }
  std::size_t waiting() const { return ready_.size() + held_.size(); }

  // Content of one record.
  struct Part {
    std::vector<Item> items;
    v1::SiteOutput output;  // `items` and `done_us`: no earlier result is left
    std::size_t left_out = 0;
  };
  // Removes the complete results, up to `most` bytes. Instants stay whole, because a successor
  // continues between two of them: an instant larger than that loses its remaining results.
  Part take(std::size_t most);
  // Removes and returns all results before `time`, as in records. REQUIRES: time <= done().
  std::vector<v1::OutputItem> take_before(Timestamp time);
  // Discards results at instants before `time`, whenever they are added.
  void begin_at(Timestamp time);

 private:
  using Key = std::tuple<Timestamp, std::string, std::size_t>;  // target, kind

  Timestamp done_;
  Timestamp from_ = Timestamp::min();  // results at earlier instants are discarded
  std::multimap<Key, Item> held_;      // at instants that are not complete
  std::deque<Item> ready_;             // ascending
};

}  // namespace rayloc
