// Places where a device may be, drawn from what a burst says: a few that stand for all.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/localize/localizer.h"

namespace rayloc {

struct SampledPlace {
  std::size_t cell = 0;
  std::size_t layer = 0;  // of Localizer::heights()
  Vec3d moved;            // [m], from the middle of both
  double share = 0.0;     // of the mass that it stands for, 1 in all
};

// Drawn at equal steps of the mass (systematic resampling), so that the same burst gives the same
// places: `count` at most, fewer where one stands for several. `evidence`: of the observation, with
// Look::kPlaces. Empty where the likelihood does not tell places apart.
std::vector<SampledPlace> sample_places(const Localizer& localizer,
                                        const RoomObservation& observation,
                                        const Localizer::Evidence& evidence,
                                        std::size_t count);

}  // namespace rayloc
