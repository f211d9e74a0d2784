// ZoneStays: who is in which zone, as a plain value: what a successor of a ZoneWatch is told.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/publish/location.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Of one target in one zone.
struct ZoneStay {
  bool is_inside = false;
  bool has_dwelled = false;
  std::optional<Timestamp> crossing;  // since when its probability speaks for the other side
  Timestamp entered;
  double probability = 0.0;
};

struct ZoneStays {
  struct Occupant {
    Target target;
    Timestamp heard;
    std::vector<ZoneStay> stays;  // by zone
  };
  std::vector<std::string> zones;   // their names
  std::vector<Occupant> occupants;  // by target_component()
  // Of each zone the occupants inside, in the order in which they came.
  std::vector<std::vector<std::size_t>> inside;
};

}  // namespace rayloc
