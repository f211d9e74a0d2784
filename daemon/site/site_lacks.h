// What a site lacks to locate as it might be expected to: a calibration, a recording of the empty
// room. Said where somebody starts to locate or asks why nothing is located.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "daemon/site/site.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct SiteLacks {
  std::vector<std::string> obstacles;  // nothing can be located
  std::vector<std::string> warnings;   // less is located than might be expected

  std::vector<std::string> all() const;  // the obstacles first
};

// `heard`: positions in Site::access_points of those whose datagrams come; empty: of all of them.
// REQUIRES: `room` was loaded of `site`.
SiteLacks site_lacks(const Site& site, const RoomModel& room, std::span<const int> heard = {});

}  // namespace rayloc
