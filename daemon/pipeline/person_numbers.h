// Number of each person of one burst: snapshots and tracks of one person are one target.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

struct PersonNumbers {
  std::uint64_t first = 1;       // of the track, or of the next where there is none
  std::uint64_t step = 1;        // between two numbers
  std::optional<Vec3d> tracked;  // [m], position of the track
};

// The person nearest to the track has the first number, or the first in the list if there is no
// track position; the others have the numbers after it.
std::vector<std::uint64_t> numbers_of(std::span<const LocationEstimate> people,
                                      const PersonNumbers& numbers);

}  // namespace rayloc
