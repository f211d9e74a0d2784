// OutItems: results in the order in which the stream of results has them, a function of the results
// alone: those of one instant together, by target and kind.
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

#include "daemon/publish/location.h"
#include "daemon/publish/target_event.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class OutItems {
 public:
  using Item = std::variant<Location, TrackEvent, ZoneEvent>;

  explicit OutItems(Timestamp done) : done_(done) {}

  void add(Item&& item);
  // Everything before `time` is there; false: that was known.
  bool advance(Timestamp time);
  // Up to where everything is there; whole microseconds, as records say it.
  Timestamp done() const { return done_; }

  // Of instants before done().
  std::size_t ready() const { return ready_.size(); }
  std::size_t waiting() const { return ready_.size() + held_.size(); }

  // What one record says.
  struct Part {
    std::vector<Item> items;
    v1::SiteOutput output;  // `items` and `done_us` of it: nothing before that is left
    std::size_t left_out = 0;
  };
  // Takes out what is ready, as far as it has `most` bytes. Instants stay whole, for a successor
  // goes on between two of them: of one that is larger than that the rest is left out.
  Part take(std::size_t most);
  // Takes out all of instants before `time`, as records would say it. REQUIRES: time <= done().
  std::vector<v1::OutputItem> take_before(Timestamp time);
  // Nothing of an instant before `time` is wanted any more, whenever it is added.
  void begin_at(Timestamp time);

 private:
  using Key = std::tuple<Timestamp, std::string, std::size_t>;  // target, kind

  Timestamp done_;
  Timestamp from_ = Timestamp::min();  // what is of an instant before is not wanted
  std::multimap<Key, Item> held_;      // of instants that are not done
  std::deque<Item> ready_;             // ascending
};

}  // namespace rayloc
