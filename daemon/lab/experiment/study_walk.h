// Walks of a study: smooth random paths of people that stay clear of walls, boxes and devices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "daemon/lab/experiment/study_places.h"
#include "daemon/lab/simulate/random_stream.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"

namespace rayloc {

struct WalkShape {
  double speed = 0.8;         // [m/s], constant
  double duration = 10.0;     // [s]
  double rate = 400.0;        // [1/s], rate of the instants
  double turn_radius = 0.35;  // [m], radius of the narrowest turn
};

// A place each 1 / rate, from 0 on: arcs of a quarter of a second with random curvatures, which
// always leave room for a full turn. `is_free`: true if a person may be at a place. Empty: no tried
// place has room for a full turn.
std::vector<Vec3d> draw_walk(const WalkShape& shape,
                             const std::function<Vec3d(RandomStream&)>& any_place,
                             const std::function<bool(const Vec3d&)>& is_free,
                             RandomStream& random);

// Condition::test_points walks of a layout. Returns an Error if the room is too narrow for them.
Expected<std::vector<std::vector<Vec3d>>> draw_walks(const StudyPlaces& places,
                                                     std::uint64_t seed,
                                                     std::size_t layout);

}  // namespace rayloc
