// A few places, drawn from the posterior of a burst, that represent the device's position.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/localize/localizer.h"

namespace rayloc {

struct SampledPlace {
  std::size_t cell = 0;
  std::size_t layer = 0;  // index in Grid::layers
  Vec3d moved;            // [m], from the centre of both
  double share = 0.0;     // share of the mass that it represents; all shares add to 1
};

// Drawn at equal steps of the mass (systematic resampling), so that the same burst gives the same
// places: at most `count`, fewer if one represents several. `evidence`: of the observation, with
// Scan::kPlaces. Empty if the likelihood cannot separate places.
std::vector<SampledPlace> sample_places(const Localizer& localizer,
                                        const RoomObservation& observation,
                                        const Localizer::Evidence& evidence,
                                        std::size_t count);

}  // namespace rayloc
