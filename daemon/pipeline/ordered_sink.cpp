#include "daemon/pipeline/ordered_sink.h"

#include <utility>

#include "daemon/publish/proto_time.h"
#include "daemon/publish/topic.h"

namespace rayloc {

void OrderedSink::location(v1::Location&& location) {
  Key key{from_proto(location.time()), target_component(location.target()), location.kind()};
  held_.emplace(std::move(key), std::move(location));
}

void OrderedSink::event(v1::ZoneEvent&& event) {
  if (write_event_) {
    write_event_(event);
  }
}

void OrderedSink::advance(Timestamp time) {
  while (!held_.empty() &&
         (std::get<Timestamp>(held_.begin()->first) < time || time == Timestamp::max())) {
    write_(held_.begin()->second);
    held_.erase(held_.begin());
  }
}

}  // namespace rayloc
