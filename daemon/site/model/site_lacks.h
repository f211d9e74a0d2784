// Data missing for the expected quality of localization: a calibration, a recording of the empty
// room. Reported when a person starts localization or asks why no target is located.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "daemon/site/model/site.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct SiteLacks {
  std::vector<std::string> obstacles;  // reasons why no target can be located
  std::vector<std::string> warnings;   // reasons for less localization than might be expected

  std::vector<std::string> all() const;  // the obstacles first
};

// `received`: positions in Site::access_points of those that send datagrams; empty: all of them.
// REQUIRES: `room` was loaded for `site`.
SiteLacks site_lacks(const Site& site,
                     const RoomModel& room,
                     std::span<const std::size_t> received = {});

}  // namespace rayloc
