#include "daemon/pipeline/ordered_sink.h"

#include <utility>

#include "daemon/messages/topic.h"

namespace rayloc {

void OrderedSink::location(Location&& location) {
  Key key{location.estimate.time, target_component(location.target), location.is_filtered()};
  held_.emplace(std::move(key), std::move(location));
}

void OrderedSink::event(ZoneEvent&& event) {
  if (write_event_) {
    write_event_(event);
  }
}

void OrderedSink::advance(Timestamp time) {
  while (!held_.empty() &&
         (std::get<Timestamp>(held_.begin()->first) + lag_ < time || time == Timestamp::max())) {
    write_(held_.begin()->second);
    held_.erase(held_.begin());
  }
}

}  // namespace rayloc
