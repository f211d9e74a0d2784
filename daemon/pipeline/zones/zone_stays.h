// ZoneStays: occupants of the zones, as a plain value: the initial state of a ZoneWatch.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/messages/location.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// State of one target in one zone.
struct ZoneStay {
  bool is_inside = false;
  bool has_dwelled = false;
  std::optional<Timestamp> crossing;  // since its probability indicates the other side
  Timestamp entered;
  double probability = 0.0;
};

struct ZoneStays {
  struct Occupant {
    Target target;
    Timestamp received;
    std::vector<ZoneStay> stays;  // by zone
  };
  std::vector<std::string> zones;   // their names
  std::vector<Occupant> occupants;  // by target_component()
  // For each zone the occupants inside, in the order of entry.
  std::vector<std::vector<std::size_t>> inside;
};

}  // namespace rayloc
