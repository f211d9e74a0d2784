// MapChannel: the agreement of a located device's channel with the one that the tracer expects at
// its position, as JSON for the map (daemon/live/http/ROUTES.md, "/api/v1/channel").
//
// Thread safety: one thread.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "daemon/pipeline/device/channel_watch.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {

class MapChannel {
 public:
  explicit MapChannel(ChannelWatch& watch) : watch_(watch) {}  // must outlive this object

  // Takes milliseconds for each new burst; more if a room is traced first.
  std::string json();

 private:
  std::string sight_json(const ChannelWatch::Sight& sight);
  const ReceiverTracer& tracer_at(const ChannelWatch::Sight& sight, const RoomAccessPoint& at);

  ChannelWatch& watch_;
  std::map<std::shared_ptr<const ChannelWatch::Sight>, std::string> made_;
  // Tracers of the daemon's rooms, which are few and permanent.
  std::map<std::pair<std::shared_ptr<const ChannelCapability>, std::string>, ReceiverTracer>
      tracers_;
};

}  // namespace rayloc
