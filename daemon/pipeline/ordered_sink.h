// OrderedSink: passes locations on ordered by (time, target, kind), as `rayloc replay` writes them.
//
// Bursts of different transmitters overlap, so locations are nearly but not exactly in the order of
// the instants they refer to; each is held until no earlier one can follow. Events of zones are
// already in order and are passed on immediately.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "daemon/messages/location.h"
#include "daemon/messages/target_event.h"
#include "daemon/pipeline/pipeline.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class OrderedSink : public LocationSink {
 public:
  // `write_event` may be empty. `lag`: maximum delay of locations beyond the pipeline's promise.
  explicit OrderedSink(std::function<void(const Location&)> write,
                       std::function<void(const ZoneEvent&)> write_event = {},
                       Duration lag = {})
      : write_(std::move(write)), write_event_(std::move(write_event)), lag_(lag) {}

  void location(Location&& location) override;
  void event(ZoneEvent&& event) override;
  void advance(Timestamp time) override;
  // Passes on all remaining locations.
  void finish() { advance(Timestamp::max()); }

 private:
  using Key = std::tuple<Timestamp, std::string, bool>;

  std::function<void(const Location&)> write_;
  std::function<void(const ZoneEvent&)> write_event_;
  Duration lag_;
  std::multimap<Key, Location> held_;
};

}  // namespace rayloc
